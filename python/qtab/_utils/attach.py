"""The results so far, carried by the exception that ends the work."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any


def attach(error: BaseException, **results: Any) -> None:
    """Makes results attributes of an exception, unless it is of a kind that takes none."""
    with suppress(AttributeError):
        for name, result in results.items():
            setattr(error, name, result)


def is_raised_in(error: BaseException, function: Callable[..., Any]) -> bool:
    """Returns whether a function raised an exception itself, or the extension did that it called.

    Neither adds a frame to the traceback, as everything in Python does that it calls.
    """
    traceback = error.__traceback__
    while traceback is not None and traceback.tb_next is not None:
        traceback = traceback.tb_next
    return traceback is not None and traceback.tb_frame.f_code is getattr(function, "__code__", None)
