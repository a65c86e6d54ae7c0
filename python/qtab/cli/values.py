"""Readers of the words that follow a flag, with messages that name the accepted words."""

import ast
import json
from argparse import ArgumentTypeError
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

from qtab._utils.shown import did_you_mean, shown

Words: TypeAlias = list[str]
"""The words that follow a flag on the command line."""


def choice(names: Sequence[str]) -> Callable[[str], str]:
    """Returns the reader of one of several names."""

    def read(word: str) -> str:
        if word not in names:
            raise ArgumentTypeError(f"must be one of {', '.join(names)}, got {shown(word)}{did_you_mean(word, names)}")
        return word

    return read


def number(word: str) -> float:
    """Reads a number."""
    try:
        return float(word)
    except ValueError:
        raise ArgumentTypeError(f"must be a number, got {shown(word)}") from None


def integer(word: str) -> int:
    """Reads an integer."""
    try:
        return int(word)
    except ValueError:
        raise ArgumentTypeError(f"must be an integer, got {shown(word)}") from None


def true_or_false(word: str) -> bool:
    """Reads True or False."""
    return choice(("True", "False"))(word) == "True"


def or_none(read: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Returns the reader that also reads the word None."""
    return lambda words: None if words in ("None", ["None"]) else read(words)


def numbers(words: Words) -> tuple[float, ...]:
    """Reads numbers."""
    return tuple(map(number, words))


def integers(words: Words) -> tuple[int, ...]:
    """Reads integers."""
    return tuple(map(integer, words))


def pairs(words: Words) -> dict[str, Any]:
    """Reads names and values in turn; a value is JSON, a Python literal or a plain word."""
    if len(words) % 2:
        raise ArgumentTypeError(f"must be pairs of a name and a value: {shown(words[-1])} has no value")
    return {key: _literal(text) for key, text in zip(words[::2], words[1::2], strict=True)}


def initial_q(words: Words) -> tuple[float, float] | float | Path:
    """Reads the bounds of a range, one number, or the file of a run."""
    if len(words) not in (1, 2):
        raise ArgumentTypeError(f"must be LOW HIGH, VALUE or FILE, got {shown(' '.join(words))}")
    if len(words) == 2:
        return number(words[0]), number(words[1])
    try:
        return float(words[0])
    except ValueError:
        return Path(words[0])


def edges(words: Words) -> tuple[Any, ...]:
    """Reads a row of numbers for each component of the observation."""
    rows = tuple(map(_literal, words))
    if not all(isinstance(row, list | tuple) for row in rows):
        given = shown(" ".join(words))
        raise ArgumentTypeError(f"must be a row such as [-0.5,0,0.5] for each component, got {given}")
    return rows


def actions(words: Words) -> int | tuple[Any, ...]:
    """Reads a number of actions, or the actions themselves."""
    values = tuple(map(_literal, words))
    if any(isinstance(value, str) for value in values):
        raise ArgumentTypeError(f"must be a count or the actions themselves, got {shown(' '.join(words))}")
    return values[0] if len(values) == 1 and isinstance(values[0], int) else values


def words_of(value: Any) -> str:
    """Returns a value as it is written after a flag."""
    if isinstance(value, Mapping):
        return " ".join(f"{key} {json.dumps(item)}" for key, item in value.items())
    if isinstance(value, tuple):
        return " ".join(map(json.dumps, value))
    return str(value)


def _literal(text: str) -> Any:
    for read in (json.loads, ast.literal_eval):
        try:
            return read(text)
        except (ValueError, SyntaxError, RecursionError, MemoryError):
            pass
    return text
