"""Suggestions for misspelled words."""

from collections.abc import Iterable
from difflib import get_close_matches


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
