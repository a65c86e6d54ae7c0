"""Spaces as text that is equal for equal spaces only, bounds and dtypes included."""

import hashlib
from typing import Any

import numpy as np
from gymnasium import spaces

_MOST_CHARACTERS = 200
_MOST_TEXTS = 1000
_texts: dict[bytes, str] = {}
"""The texts of small spaces: NumPy takes longer to show bounds than the rest of a description takes."""


def space_text(space: Any) -> str:
    """Returns the text of a space, with a digest of all of it."""
    if isinstance(space, spaces.Discrete):
        return f"Discrete({space.n}, start={space.start})"
    encoded = _encoded(space)
    found = _texts.get(encoded)
    if found is None:
        shown = " ".join(repr(space).split())
        if len(shown) > _MOST_CHARACTERS:
            shown = f"{shown[: _MOST_CHARACTERS - 3]}..."
        found = f"{shown} #{hashlib.sha256(encoded).hexdigest()[:16]}"
        if len(_texts) < _MOST_TEXTS and len(encoded) < _MOST_TEXTS:
            _texts[encoded] = found
    return found


def without_digest(text: str) -> str:
    """Returns the text of a space as messages show it."""
    return text.rpartition(" #")[0] or text


def _encoded(space: Any) -> bytes:
    if isinstance(space, spaces.Box):
        return b"".join([b"Box", str(space.shape).encode(), space.dtype.str.encode(), _bytes(space.low, space.high)])
    if isinstance(space, spaces.MultiDiscrete):
        return b"MultiDiscrete" + str(space.shape).encode() + _bytes(space.nvec, space.start)
    if isinstance(space, spaces.Dict):
        return b"Dict" + b"".join(repr(key).encode() + _encoded(part) for key, part in space.items())
    if isinstance(space, spaces.Tuple):
        return b"Tuple" + b"".join(map(_encoded, space))
    return space_text(space).encode() if isinstance(space, spaces.Discrete) else repr(space).encode()


def _bytes(*arrays: Any) -> bytes:
    return b"".join(np.ascontiguousarray(array).tobytes() for array in arrays)
