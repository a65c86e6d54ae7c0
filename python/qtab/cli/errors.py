"""Errors in one line, with the arguments as they are typed; usage errors are those that the user can correct."""

import re
import traceback
from argparse import Namespace
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

import gymnasium as gym

from qtab._utils.shown import shown


class UsageError(Exception):
    """A command line that cannot be run. The message is shown to the user."""


USER_ERRORS = (
    ValueError,
    TypeError,
    OverflowError,
    OSError,
    MemoryError,
    RecursionError,
    ModuleNotFoundError,
    gym.error.Error,
)
"""The errors that bad arguments, files and environments raise."""


def one_line(error: BaseException) -> str:
    """Returns the message of an error without line breaks, or the name of its type if it has none."""
    if isinstance(error, OSError) and error.strerror is not None and error.filename is not None:
        return f"{error.strerror}: {shown(str(error.filename))}"
    return " ".join(str(error).split()) or type(error).__name__


def with_origin(error: Exception) -> str:
    """Returns the message of an unexpected error, such as one of the user's environment, with its type and line."""
    *_, last = traceback.extract_tb(error.__traceback__) or [None]
    where = "" if last is None else f" (at {last.filename}:{last.lineno})"
    return f"{type(error).__name__}: {one_line(error)}{where}"


@contextmanager
def usage_errors(options: Namespace | None = None) -> Iterator[None]:
    """Turns the errors that bad arguments cause inside the context into a :class:`UsageError`.

    Args:
        options: The arguments of the command. Messages about its ``flags`` spell them as flags, and those about its
            ``positionals`` as ``--help`` does. None leaves the message unchanged.
    """
    try:
        yield
    except USER_ERRORS as error:
        message = one_line(error)
        if options is not None:
            word = message.partition(" must ")[0]
            if word in options.positionals:
                message = word.upper() + message.removeprefix(word)
            message = as_flags(message, options.flags)
        raise UsageError(message) from error


@contextmanager
def reading(argument: str, path: Path) -> Iterator[None]:
    """Turns the errors of reading a file into a :class:`UsageError` that names the argument and the file."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or one_line(error)
        raise UsageError(f"{argument} must be a file that can be read, got {shown(str(path))}: {reason}") from None


def flag(name: str) -> str:
    """Returns an argument of the API as it is typed on the command line."""
    return f"--{name.replace('_', '-')}"


def as_flags(message: str, names: Collection[str]) -> str:
    """Returns a message of the API with arguments spelled as flags: where it names them, not where it quotes a word."""
    if not names:
        return message
    words = "|".join(sorted(names, key=len, reverse=True))
    compound = "|".join(sorted((name for name in names if "_" in name), key=len, reverse=True)) or "(?!)"
    # At the beginning; before "= value" or "='value'"; before a quoted choice; and everywhere if no English word.
    for pattern in (
        rf"^(?P<name>{words})(?= (?:must|applies|needs)\b)",
        rf"(?<![\w'-])(?P<name>{words})(?= ?= ?|=$)",
        rf"(?<=to |or |th |se )(?P<name>{words})(?= ')",
        rf"(?<![\w'-])(?P<name>{compound})(?![\w'])",
    ):
        message = re.sub(pattern, lambda found: flag(found["name"]), message)
    return re.sub(r"(--[\w-]+)=(?=[ ,;.]|$)", r"\1", message)
