"""Bad usage: what the user can put right, told in one line before any work is done."""

from collections.abc import Iterator
from contextlib import contextmanager

import gymnasium as gym


class UsageError(Exception):
    """A command line that cannot be run; its message is for the user."""


def one_line(error: BaseException) -> str:
    """Returns an error's message without line breaks, or its type where it has none."""
    return " ".join(str(error).split()) or type(error).__name__


@contextmanager
def refusing() -> Iterator[None]:
    """Turns what is refused inside into a :class:`UsageError`."""
    try:
        yield
    except (ValueError, TypeError, OSError, ModuleNotFoundError, gym.error.Error) as error:
        raise UsageError(one_line(error)) from error
