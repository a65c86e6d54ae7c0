"""How the words that follow a flag are read, with messages of our own where they cannot be."""

import ast
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypeAlias

import tyro

from qtab._utils.shown import shown
from qtab._utils.suggestions import did_you_mean

Words: TypeAlias = list[str]
"""What follows a flag on the command line."""


def constructor(
    metavar: str, nargs: Literal[1, "*"], read: Callable[[Words], Any], *, optional: bool = False
) -> tyro.constructors.PrimitiveConstructorSpec[Any]:
    """Returns a constructor for tyro, whose messages say what the words must be.

    Args:
        metavar: What ``--help`` shows after the flag.
        nargs: How many words follow the flag.
        read: Returns the value of the words. Its ValueErrors say what they must be.
        optional: Whether the word None is read as None.
    """
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs=nargs,
        metavar=metavar,
        instance_from_str=lambda words: None if optional and words == ["None"] else read(words),
        is_instance=lambda _: True,
        str_from_instance=lambda value: words_of(value).split(),
    )


def words_of(value: Any) -> str:
    """Returns a value as it is written after a flag."""
    if isinstance(value, Mapping):
        return " ".join(f"{key} {json.dumps(item)}" for key, item in value.items())
    if isinstance(value, tuple):
        return " ".join(map(json.dumps, value))
    return str(value)


def read_choice(words: Words, choices: Sequence[str]) -> str:
    """Reads one of several names."""
    (word,) = words
    if word not in choices:
        raise ValueError(f"must be one of {', '.join(choices)}, got {shown(word)}{did_you_mean(word, choices)}")
    return word


def read_float(words: Words) -> float:
    """Reads a number."""
    try:
        return float(words[0])
    except ValueError:
        raise ValueError(f"must be a number, got {shown(words[0])}") from None


def read_int(words: Words) -> int:
    """Reads an integer."""
    try:
        return int(words[0])
    except ValueError:
        raise ValueError(f"must be an integer, got {shown(words[0])}") from None


def read_str(words: Words) -> str:
    """Reads a word as it is."""
    return words[0]


def read_flag(words: Words) -> bool:
    """Reads True or False."""
    return read_choice(words, ("True", "False")) == "True"


def read_floats(words: Words) -> tuple[float, ...]:
    """Reads numbers."""
    return tuple(read_float([word]) for word in words)


def read_ints(words: Words) -> tuple[int, ...]:
    """Reads integers."""
    return tuple(read_int([word]) for word in words)


def read_pairs(words: Words) -> dict[str, Any]:
    """Reads names and values in turn; a value is JSON, a Python literal or a plain word."""
    if len(words) % 2:
        raise ValueError(f"must be pairs of a name and a value: {shown(words[-1])} has no value")
    return {key: _literal(text) for key, text in zip(words[::2], words[1::2], strict=True)}


def read_initial_q(words: Words) -> tuple[float, float] | float | Path:
    """Reads the bounds of a range, one number, or the file of a run."""
    if len(words) not in (1, 2):
        raise ValueError(f"must be LOW HIGH, VALUE or FILE, got {shown(' '.join(words))}")
    if len(words) == 2:
        return read_float(words[:1]), read_float(words[1:])
    try:
        return float(words[0])
    except ValueError:
        return Path(words[0])


def read_edges(words: Words) -> tuple[Any, ...]:
    """Reads a row of numbers for each component of the observation."""
    rows = tuple(map(_literal, words))
    if not all(isinstance(row, list | tuple) for row in rows):
        raise ValueError(f"must be a row such as [-0.5,0,0.5] for each component, got {shown(' '.join(words))}")
    return rows


def read_actions(words: Words) -> int | tuple[Any, ...]:
    """Reads a number of actions, or the actions themselves."""
    values = tuple(map(_literal, words))
    if any(isinstance(value, str) for value in values):
        raise ValueError(f"must be a count or the actions themselves, got {shown(' '.join(words))}")
    return values[0] if len(values) == 1 and isinstance(values[0], int) else values


def _literal(text: str) -> Any:
    for read in (json.loads, ast.literal_eval):
        try:
            return read(text)
        except (ValueError, SyntaxError, RecursionError, MemoryError):
            pass
    return text


PAIRS = constructor("[KEY VALUE ...]", "*", read_pairs)
"""Keyword arguments."""

OPTIONAL_INT = constructor("INT", 1, read_int, optional=True)
"""An integer, or None."""
FLOAT = constructor("FLOAT", 1, read_float)
"""A number."""
INT = constructor("INT", 1, read_int)
"""An integer."""
OPTIONAL_FLOAT = constructor("FLOAT", 1, read_float, optional=True)
"""A number, or None."""
