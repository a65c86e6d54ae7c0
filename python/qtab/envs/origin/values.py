"""Values of arguments and attributes as JSON can hold them: exact if possible, else a digest to compare.

Spaces are text that is equal for equal spaces only, bounds and dtypes included.
"""

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from qtab.envs.origin.class_code import function_code

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


MOST_BYTES = 4096
"""Larger arrays are described by a digest."""
_TAG = "is"


class NotRestorableError(ValueError):
    """Raised for a value that is known only by its description. The message describes it."""


def describe_value(value: Any) -> Any:
    """Returns a value as JSON can hold it, equal for equal values; any other value is described by its type."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int | str):
        return int(value) if isinstance(value, int) else str(value)
    if isinstance(value, float) and not isinstance(value, np.generic):
        return float(value) if math.isfinite(value) else {_TAG: "float", "value": repr(float(value))}
    if isinstance(value, np.ndarray | np.generic):
        return _describe_array(np.asarray(value))
    if isinstance(value, tuple):
        return {_TAG: "tuple", "items": [describe_value(item) for item in value]}
    if isinstance(value, list):
        return [describe_value(item) for item in value]
    if isinstance(value, Mapping) and all(isinstance(key, str) for key in value):
        return {_TAG: "dict", "items": describe_values(value)}
    if isinstance(value, gym.Space):
        return {_TAG: "space", "text": space_text(value)}
    if isinstance(value, type):
        return {_TAG: "class", "name": f"{value.__module__}:{value.__qualname__}"}
    if callable(value) and hasattr(value, "__code__"):
        return {_TAG: "function", "name": value.__qualname__, "code": function_code(value)}
    return {_TAG: "object", "name": f"{type(value).__module__}:{type(value).__qualname__}"}


def describe_values(values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns each value as :func:`describe_value` does."""
    return {name: describe_value(value) for name, value in values.items()}


def _describe_array(array: Any) -> dict[str, Any]:
    content: dict[str, Any] = {_TAG: "array", "dtype": array.dtype.str, "shape": list(array.shape)}
    if array.dtype.hasobject:
        return {_TAG: "object", "name": "numpy:ndarray"}
    data = np.ascontiguousarray(array).tobytes()
    return {**content, "bytes": data.hex()} if len(data) <= MOST_BYTES else {**content, "sha256": sha256(data)}


def is_plain(value: Any) -> bool:
    """Returns whether a value is a number, text, or an array, tuple or list of them, which its description restores."""
    try:
        restored(describe_value(value))
    except NotRestorableError:
        return False
    return True


def restored(content: Any) -> Any:
    """Returns the value of a description.

    Raises:
        NotRestorableError: if only a digest or a type is known.
    """
    if isinstance(content, list):
        return [restored(item) for item in content]
    if not isinstance(content, dict):
        return content
    match content:
        case {"is": "float", "value": "inf" | "-inf" | "nan" as text}:
            return float(text)
        case {"is": "array", "dtype": str(dtype), "shape": list(shape), "bytes": str(data)}:
            return _array(dtype, shape, data)
        case {"is": "tuple", "items": list(items)}:
            return tuple(restored(item) for item in items)
        case {"is": "dict", "items": dict(items)}:
            return {name: restored(item) for name, item in items.items()}
    raise NotRestorableError(in_words(content))


def with_types(stored: Mapping[str, Any], descriptions: Mapping[str, Any]) -> dict[str, Any]:
    """Returns arguments from JSON with their original types, such as tuples, if their descriptions agree."""
    return {name: _with_type(value, descriptions.get(name)) for name, value in stored.items()}


def _with_type(value: Any, content: Any) -> Any:
    try:
        found = restored(content)
        agrees = json.loads(json.dumps(found)) == value
    except (TypeError, ValueError):
        return value
    return found if agrees else value


def _array(dtype: str, shape: list[Any], data: str) -> Any:
    try:
        found = np.frombuffer(bytes.fromhex(data), np.dtype(dtype)).reshape(shape).copy()
    except (TypeError, ValueError):
        raise NotRestorableError("a damaged array") from None
    return found if shape else found[()]


def same(one: Any, other: Any) -> bool:
    """Returns whether two descriptions of a value are equal as far as is known."""
    if isinstance(one, dict) and isinstance(other, dict):
        if one.keys() != other.keys():
            return False
        unknown = one.get(_TAG) == "function" and not are_comparable(one.get("code"), other.get("code"))
        return all(same(one[name], other[name]) for name in one if not (unknown and name == "code"))
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return type(one) is type(other) and bool(one == other)


def are_comparable(one: str | None, other: str | None) -> bool:
    """Returns whether two digests of code can be compared: both are known, and were made by the same Python."""
    return one is not None and other is not None and one.partition(":")[0] == other.partition(":")[0]


def in_words(content: Any) -> str:
    """Returns a described value as messages show it."""
    match content:
        case {"is": "function", "name": name}:
            return f"the function {name}"
        case {"is": "class", "name": name}:
            return f"the class {name}"
        case {"is": "object", "name": name}:
            return f"an object of {name}"
        case {"is": "space", "text": text}:
            return f"the space {text}"
        case {"is": "array", "shape": shape, "sha256": _}:
            return f"an array of shape {tuple(shape)}"
        case list():
            return f"[{', '.join(map(in_words, content))}]"
    try:
        text = repr(restored(content))
    except NotRestorableError as error:
        return str(error)
    return text if len(text) <= 100 else f"{text[:97]}..."


def sha256(data: bytes) -> str:
    """Returns the first 32 hexadecimal digits of a digest."""
    return hashlib.sha256(data).hexdigest()[:32]
