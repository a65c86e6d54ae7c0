"""Attaches the results so far to the exception that ends the work."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any


def attach(error: BaseException, **results: Any) -> None:
    """Sets results as attributes of an exception, unless its class does not allow attributes."""
    with suppress(AttributeError):
        for name, result in results.items():
            setattr(error, name, result)


def is_raised_in(error: BaseException, function: Callable[..., Any]) -> bool:
    """Returns whether an exception was raised by a function itself or by the extension that it called.

    Neither adds a frame to the traceback, unlike Python functions that it calls.
    """
    traceback = error.__traceback__
    while traceback is not None and traceback.tb_next is not None:
        traceback = traceback.tb_next
    return traceback is not None and traceback.tb_frame.f_code is getattr(function, "__code__", None)
