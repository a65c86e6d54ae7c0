"""A part of an observation space: a space without subspaces, and its path."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab._utils.shown import shown

SMALL = 1024
"""An integer Box with at most this many values per component indexes the table; a larger one is discretized."""


@dataclass(frozen=True)
class Part:
    """A space without subspaces, whose components are in C order."""

    path: tuple[str | int, ...]
    """The keys and indices of the part in an observation."""
    shape: tuple[int, ...]
    low: tuple[float, ...]
    """The lower bound of each component, which can be infinite; integers unless ``kind`` is ``"float"``."""
    high: tuple[float, ...]
    kind: str
    """``"index"`` for a discrete space, ``"integer"`` for a Box of integers, ``"float"`` for a Box of floats."""
    single: bool = False
    """Whether the floats have at most the precision of float32."""

    @property
    def size(self) -> int:
        """The number of components."""
        return len(self.low)

    @property
    def is_bounded(self) -> bool:
        """Whether every component has finite bounds."""
        return all(map(math.isfinite, (*self.low, *self.high)))

    @property
    def is_small(self) -> bool:
        """Whether it has few integers, so that it indexes the table unless another discretizer is given."""
        if self.kind == "index":
            return True
        if self.kind == "float" or not self.is_bounded:
            return False
        return all(high - low < SMALL and abs(low) < 2**62 for low, high in zip(self.low, self.high, strict=True))

    @property
    def name(self) -> str:
        """The name in messages: ``observation['agent']``."""
        return "observation" + "".join(f"[{key!r}]" for key in self.path)

    def names(self) -> Iterator[str]:
        """Yields a name for each component, such as ``agent[0]``."""
        first, *others = self.path or ("observation",)
        stem = first if isinstance(first, str) else f"observation[{first}]"
        stem += "".join(f".{key}" if isinstance(key, str) else f"[{key}]" for key in others)
        for index in product(*map(range, self.shape)):
            yield stem + (f"[{', '.join(map(str, index))}]" if index else "")

    def find(self, observation: Any) -> NDArray[Any]:
        """Returns this part of an observation.

        Raises:
            ValueError: if the observation has no such part.
        """
        for key in self.path:
            try:
                observation = observation[key]
            except (KeyError, IndexError, TypeError):
                raise ValueError(f"an observation must have a part {self.name}, as the space has") from None
        return np.asarray(observation)

    def numbers(self, values: NDArray[Any]) -> NDArray[Any]:
        """Checks that values are numbers of this part's kind, and returns them.

        Raises:
            TypeError: if they are not.
        """
        if values.dtype.kind in ("iub" if self.kind != "float" else "iubf"):
            return values
        if values.dtype.kind == "f" and (np.rint(values) == values).all() and (np.abs(values) < 2.0**63).all():
            return values
        wanted = "numbers" if self.kind == "float" else "integers"
        raise TypeError(f"{self.name} must hold {wanted}, as the space does, got {values.tolist()!r:.80}")


def restored_part(stored: Any) -> Part:
    """Returns a part in a file, after checking it.

    Raises:
        KeyError: if a key is missing.
        ValueError: if ``stored`` is not a part of a space.
    """
    path, shape, low, high = (tuple(stored[name]) for name in ("path", "shape", "low", "high"))
    kind, single = stored["kind"], stored["single"]
    numbers = (*low, *high)
    integral = all(isinstance(number, int) or math.isinf(number) for number in numbers)
    fits = (
        kind in ("index", "integer", "float")
        and isinstance(single, bool)
        and all(isinstance(key, str | int) for key in path)
        and all(isinstance(size, int) and size >= 0 for size in shape)
        and math.prod(shape) == len(low) == len(high)
        and all(isinstance(number, int | float) and not math.isnan(number) for number in numbers)
        and (kind == "float" or integral)
        and (kind != "index" or all(isinstance(number, int) for number in numbers))
        and all(first <= last for first, last in zip(low, high, strict=True))
    )
    if not fits:
        raise ValueError("its observations are not those of a space")
    return Part(path, shape, low, high, kind, single)


def parts_of(space: Any, whole: Any, path: tuple[str | int, ...] = ()) -> Iterator[Part]:
    """Yields the parts of a space, which is at ``path`` in the whole space.

    Raises:
        ValueError: if a table cannot represent the space; the message suggests a remedy.
    """
    if isinstance(space, spaces.Dict):
        for key, part in space.spaces.items():
            yield from parts_of(part, whole, (*path, key))
    elif isinstance(space, spaces.Tuple):
        for index, part in enumerate(space.spaces):
            yield from parts_of(part, whole, (*path, index))
    else:
        yield _part(space, whole, path)


def _part(space: Any, whole: Any, path: tuple[str | int, ...]) -> Part:
    if not all(isinstance(key, str | int) for key in path):
        raise ValueError(f"the observation space must have strings as the keys of its Dict, got {path[-1]!r}")
    if isinstance(space, spaces.Discrete):
        first = int(space.start)
        return Part(path, (), (first,), (first + int(space.n) - 1,), "index")
    if isinstance(space, spaces.MultiDiscrete):
        starts = np.broadcast_to(space.start, space.nvec.shape).ravel().tolist()
        lasts = [first + int(count) - 1 for first, count in zip(starts, space.nvec.ravel().tolist(), strict=True)]
        return Part(path, space.nvec.shape, tuple(starts), tuple(lasts), "index")
    if isinstance(space, spaces.MultiBinary):
        count = math.prod(space.shape)
        return Part(path, space.shape, (0,) * count, (1,) * count, "index")
    if isinstance(space, spaces.Box) and space.dtype is not None:
        low, high = space.low.ravel(), space.high.ravel()
        if space.dtype.kind == "b":
            return Part(path, space.shape, tuple(map(int, low)), tuple(map(int, high)), "index")
        if space.dtype.kind in "iu":
            lows = np.where(space.bounded_below.ravel(), low.astype(object), -math.inf).tolist()
            highs = np.where(space.bounded_above.ravel(), high.astype(object), math.inf).tolist()
            return Part(path, space.shape, tuple(lows), tuple(highs), "integer")
        if space.dtype in (np.float16, np.float32, np.float64):
            bounds = tuple(low.astype(np.float64).tolist()), tuple(high.astype(np.float64).tolist())
            return Part(path, space.shape, *bounds, "float", space.dtype != np.float64)
    raise ValueError(refusal(space, whole, path))


FUNCTION = "a function as discretizer= with shape= or max_rows="


def refusal(space: Any, whole: Any, path: tuple[str | int, ...]) -> str:
    """Returns the reason why a table cannot represent a space, and a remedy.

    Args:
        space: The space.
        whole: The observation space that contains it, or ``space`` itself.
        path: The keys of the space in ``whole``.
    """
    where = f"under {path[0]!r}" if path else "at the top level"
    text = (
        f"the observation space must consist of numbers for a table, got {type(space).__name__} {where}: {shown(whole)}"
    )
    others = [key for key in whole.spaces if key != path[0]] if isinstance(whole, spaces.Dict) and path else []
    if others:
        return f"{text}; gymnasium.wrappers.FilterObservation(env, {others!r}) leaves it out, or give {FUNCTION}"
    if isinstance(space, spaces.Box):
        return f"{text}; gymnasium.wrappers.DtypeObservation(env, numpy.float64) converts it"
    return f"{text}; gymnasium.wrappers.TransformObservation converts it to numbers with a function, or give {FUNCTION}"


def too_large(parts: Any) -> str:
    """Returns a remedy for discrete spaces that are too large for a table, to be added to a message."""
    image = any(part.kind == "integer" and len(part.shape) in (2, 3) and part.size >= 64 for part in parts)
    if image:
        return (
            " (it holds an image: max_rows= assigns rows only to the images that are seen; "
            "gymnasium.wrappers.TransformObservation or a function as discretizer= with shape= reduces it)"
        )
    return (
        " (max_rows= assigns rows only to the observations that are seen; "
        "a function as discretizer= with shape= reduces their number)"
    )
