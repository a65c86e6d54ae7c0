"""The observation that a rewritten function returns: a number, an array, or a tuple in the order of the space."""

from collections.abc import Callable
from typing import Any

import numpy as np
from gymnasium import spaces

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.values import BOOL, INT, WIDE, Array, DictKind, Scalar, TupleKind, in_words

Refuse = Callable[[str, str], NotCompilable]


def observation_code(space: Any, kind: Any, code: str, refuse: Refuse) -> str:
    """Returns the code of an observation; dicts become tuples in the order of the space.

    Args:
        space: The observation space.
        kind: The kind of the value that the class returns.
        code: Its code, which may be evaluated several times.
        refuse: Makes an error.
    """
    shown = f"the observation is {in_words(kind)}, the space {' '.join(str(space).split())}"
    if isinstance(space, spaces.Dict):
        if not isinstance(kind, DictKind) or set(kind.keys) != set(space.spaces):
            raise refuse(shown, "return a dict with the keys of the space")
        order = [kind.keys.index(key) for key in space.spaces]
        return _parts(list(space.spaces.values()), [(kind.items[i], f"{code}[{i}]") for i in order], refuse)
    if isinstance(space, spaces.Tuple):
        if not isinstance(kind, TupleKind) or len(kind.items) != len(space.spaces):
            raise refuse(shown, "return a tuple as long as the space")
        return _parts(list(space.spaces), [(item, f"{code}[{i}]") for i, item in enumerate(kind.items)], refuse)
    if isinstance(space, spaces.Discrete):
        if kind not in (INT, BOOL) and not (isinstance(kind, Scalar) and kind.name.startswith(("int", "uint"))):
            raise refuse(shown, "return an integer")
        return f"int({code})"
    if isinstance(kind, Array):
        if kind.shape is not None and kind.shape != space.shape:
            raise refuse(shown, "return an array of the shape of the space")
        if np.dtype(kind.dtype).kind == "f" and space.dtype.kind != "f":
            raise refuse(shown, "return an array of the dtype of the space")
        return code
    raise refuse(shown, "return np.array([...], dtype=...)")


def _parts(inner: list[Any], values: list[tuple[Any, str]], refuse: Refuse) -> str:
    codes = []
    for space, (kind, code) in zip(inner, values, strict=True):
        plain = kind in WIDE and space.shape == () and isinstance(space, spaces.Box)
        codes.append(code if plain else observation_code(space, kind, code, refuse))
    return f"({', '.join(codes)},)"
