"""The results so far, carried by the exception that ends the work."""

from contextlib import suppress
from typing import Any


def attach(error: BaseException, **results: Any) -> None:
    """Makes results attributes of an exception, unless it is of a kind that takes none."""
    with suppress(AttributeError):
        for name, result in results.items():
            setattr(error, name, result)
