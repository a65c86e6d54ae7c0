"""Short texts for error messages: values, and suggestions for misspelled words."""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

LONGEST_ARRAY = 200
"""The maximum number of characters of an array; of a longer one, the shape and the dtype are shown."""
LONGEST = 450
"""The maximum number of characters; longer texts, such as those of tables, are cut in the middle."""


def shown(value: Any) -> str:
    """Returns the ``repr`` of a value, without the middle of a long one; of a large array, its shape and dtype."""
    try:
        text = repr(value)
    except Exception:  # such as an integer with more digits than Python prints
        bits = f" of {value.bit_length():,} bits" if isinstance(value, int) else ""
        text = f"<{type(value).__name__}{bits}>"
    if isinstance(value, np.ndarray) and len(text) > LONGEST_ARRAY:
        return f"an array of shape {value.shape} and dtype {value.dtype}"
    if len(text) <= LONGEST:
        return text
    half = LONGEST // 2
    return f"{text[:half]} ... {text[-half:]}"


def plural(noun: str, count: int) -> str:
    """Returns the noun of a count: ``"number"`` for 1, ``"numbers"`` otherwise."""
    return noun if count == 1 else f"{noun}s"


def counted(count: int, noun: str) -> str:
    """Returns a count with its noun: ``"1 number"``, ``"2 numbers"``."""
    return f"{count:,} {plural(noun, count)}"


def last_of(count: int, noun: str = "") -> str:
    """Returns ``"last number"`` or ``"last 100 numbers"``; ``"last"`` or ``"last 100"`` without a noun."""
    number = "" if count == 1 else f" {count:,}"
    return f"last{number} {plural(noun, count)}" if noun else f"last{number}"


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Returns the known word with the spelling nearest to ``word``, ignoring case; None if none is near."""
    by_spelling = {_spelling(candidate): candidate for candidate in known}
    found = get_close_matches(_spelling(word), by_spelling, n=1, cutoff=0.65)
    return by_spelling[found[0]] if found else None


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Returns the end of an error message, `` (did you mean 'x'?)``; empty if no known word is near."""
    found = nearest(word, known)
    return "" if found is None else f" (did you mean {found!r}?)"


def _spelling(word: str) -> str:
    return word.lower().replace("-", "_").replace(" ", "_")


def listed(words: Sequence[str]) -> str:
    """Returns words as an English list: ``'a', 'b' or 'c'``."""
    *others, last = map(repr, words)
    return f"{', '.join(others)} or {last}" if others else last
