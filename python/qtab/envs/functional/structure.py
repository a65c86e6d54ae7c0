"""The structure of a state: its nesting of tuples, and the shapes of its arrays."""

from typing import Any, TypeAlias

import numpy as np

from qtab._utils.shown import counted

Structure: TypeAlias = Any
"""``NUMBER``; a tuple of the type of a tuple and the structures of its items; the shape of an array in a list; or the
type of any other object."""

NUMBER = "number"
_NUMBERS = (bool, int, float, np.number, np.bool_)


def structure_of(state: Any) -> Structure:
    """Returns the structure of a state.

    Booleans, integers and floats count as numbers, so that a count may become a fraction. Of objects that are neither
    numbers, tuples nor arrays, only the type counts.
    """
    if isinstance(state, _NUMBERS):
        return NUMBER
    if isinstance(state, tuple):
        return (type(state), *map(structure_of, state))
    if isinstance(state, np.ndarray):
        return [state.shape]
    return type(state)


def in_words(structure: Structure) -> str:
    """Returns a structure in words: ``"a tuple of (a number, an array of shape (2,))"``."""
    if structure == NUMBER:
        return "a number"
    if isinstance(structure, list):
        return f"an array of shape {structure[0]}"
    if isinstance(structure, type):
        return f"a {structure.__name__}"
    cls, *items = structure
    named = "tuple" if cls is tuple else cls.__name__
    if all(item == NUMBER for item in items):
        return f"a {named} of {counted(len(items), 'number')}"
    return f"a {named} of ({', '.join(map(in_words, items))})"
