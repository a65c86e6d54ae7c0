"""Usage errors: what the user can correct, reported in one line before any work starts."""

from collections.abc import Iterator
from contextlib import contextmanager

import gymnasium as gym


class UsageError(Exception):
    """A command line that cannot be run. The message is shown to the user."""


def one_line(error: BaseException) -> str:
    """Returns the message of an error without line breaks, or the name of its type if it has none."""
    return " ".join(str(error).split()) or type(error).__name__


@contextmanager
def usage_errors() -> Iterator[None]:
    """Turns the errors that bad arguments cause inside the context into a :class:`UsageError`."""
    try:
        yield
    except (ValueError, TypeError, OSError, ModuleNotFoundError, gym.error.Error) as error:
        raise UsageError(one_line(error)) from error
