"""The layout of an observation space: any nesting of spaces as one row of components, in Gymnasium's order."""

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab.discretizers.refusals import refusal

SMALL = 1024
"""An integer Box of at most this many values a component indexes the table; a larger one is discretized."""


@dataclass(frozen=True)
class Part:
    """A space without spaces in it, whose components follow each other in C order."""

    path: tuple[str | int, ...]
    """The keys and indices under which it is found in an observation."""
    shape: tuple[int, ...]
    low: tuple[float, ...]
    """The lower bound of each component: integers where ``kind`` is not ``"float"``; it can be infinite."""
    high: tuple[float, ...]
    kind: str
    """``"index"`` for a space that is discrete, ``"integer"`` for a Box of integers, ``"float"`` for one of floats."""
    single: bool = False
    """Whether the floats have at most the precision of float32."""

    @property
    def size(self) -> int:
        """The number of its components."""
        return len(self.low)

    @property
    def is_bounded(self) -> bool:
        """Whether every component has finite bounds."""
        return all(map(math.isfinite, (*self.low, *self.high)))

    @property
    def is_small(self) -> bool:
        """Whether it takes few integers, so that it indexes the table unless another discretizer is asked for."""
        if self.kind == "index":
            return True
        if self.kind == "float" or not self.is_bounded:
            return False
        return all(high - low < SMALL and abs(low) < 2**62 for low, high in zip(self.low, self.high, strict=True))

    @property
    def name(self) -> str:
        """How messages name it: ``observation['agent']``."""
        return "observation" + "".join(f"[{key!r}]" for key in self.path)

    def names(self) -> Iterator[str]:
        """Yields a name for each of its components, such as ``agent[0]``."""
        first, *others = self.path or ("observation",)
        stem = first if isinstance(first, str) else f"observation[{first}]"
        stem += "".join(f".{key}" if isinstance(key, str) else f"[{key}]" for key in others)
        for index in product(*map(range, self.shape)):
            yield stem + (f"[{', '.join(map(str, index))}]" if index else "")

    def find(self, observation: Any) -> NDArray[Any]:
        """Returns its part of an observation.

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
        """Checks that values are numbers of its kind.

        Raises:
            TypeError: if they are not.
        """
        if values.dtype.kind in ("iub" if self.kind != "float" else "iubf"):
            return values
        if values.dtype.kind == "f" and (np.rint(values) == values).all():
            return values
        wanted = "numbers" if self.kind == "float" else "integers"
        raise TypeError(f"{self.name} must hold {wanted}, as the space does, got {values.tolist()!r:.80}")


@dataclass(frozen=True)
class Layout:
    """The parts of an observation space, in Gymnasium's order: that of ``Dict.spaces`` and of ``Tuple.spaces``."""

    parts: tuple[Part, ...]

    @classmethod
    def of_space(cls, space: Any) -> "Layout":
        """Returns the layout of an observation space.

        Raises:
            ValueError: if a table cannot serve it; the message says what would help.
        """
        layout = cls(tuple(_parts(space, space, ())))
        if not layout.size:
            raise ValueError(f"the observation space must have at least one component, got {space}")
        return layout

    @property
    def size(self) -> int:
        """The number of components."""
        return sum(part.size for part in self.parts)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """A name for each component."""
        return tuple(name for part in self.parts for name in part.names())

    def keys(self) -> dict[str, list[Part]]:
        """Returns the parts under each key of the outermost Dict, or each index of the outermost Tuple."""
        found: dict[str, list[Part]] = {}
        for part in self.parts:
            if part.path:
                found.setdefault(str(part.path[0]), []).append(part)
        return found

    def components(self, parts: "list[Part] | tuple[Part, ...]") -> list[int]:
        """Returns the indices of the components of some parts."""
        indices: list[int] = []
        first = 0
        for part in self.parts:
            if part in parts:
                indices += range(first, first + part.size)
            first += part.size
        return indices

    def name_of(self, component: int) -> str:
        """Returns how messages name a component: ``observation['agent'][0]``."""
        for part in self.parts:
            if component < part.size:
                index = [str(number) for number in np.unravel_index(component, part.shape)] if part.shape else []
                return part.name + (f"[{', '.join(index)}]" if index else "")
            component -= part.size
        raise IndexError(component)

    def batch_size(self, observation: Any) -> int | None:
        """Returns how many observations there are, batched as in Gymnasium's vector environments; None for one.

        Raises:
            ValueError: if an observation has another shape than the space.
        """
        if self._is_flat(observation):
            shape = np.shape(observation)
            return shape[0] if len(shape) == 2 else None
        counts = set()
        for part in self.parts:
            shape = part.find(observation).shape
            if shape != part.shape and shape[1:] != part.shape:
                raise ValueError(f"{part.name} must have shape {part.shape}, the space's, got {shape}")
            counts.add(None if shape == part.shape else shape[0])
        if len(counts) > 1:
            raise ValueError(f"observations must be batched alike in all their parts, got {sorted(map(str, counts))}")
        return counts.pop()

    def flat(
        self,
        observation: Any,
        dtype: Any,
        first: Sequence[NDArray[np.int64] | None],
        batch: int | None = None,
    ) -> NDArray[Any]:
        """Returns the components of an observation, (size,), or those of a batch, (n, size).

        Args:
            observation: An observation, or several that are batched.
            dtype: The dtype of the result.
            first: For each part whose components are indices, what to subtract from them; None for the others.
            batch: How many observations there are; None for one.

        Raises:
            TypeError: if they are not numbers of the kinds that the space has.
            ValueError: if an observation has another shape than the space.
        """
        shape = () if batch is None else (batch,)
        is_flat = self._is_flat(observation)
        flat = np.empty((*shape, self.size), dtype=dtype)
        start = 0
        for part, offset in zip(self.parts, first, strict=True):
            stop = start + part.size
            values = observation[..., start:stop] if is_flat else part.find(observation)
            if not is_flat:
                if values.shape != (*shape, *part.shape):
                    raise ValueError(f"{part.name} must have shape {part.shape}, the space's, got {values.shape}")
                values = values.reshape(*shape, part.size)
            elif offset is not None and values.dtype.kind == "f":
                values = np.rint(values)  # coordinates, of which an index has the cell from -0.5 to 0.5 around it
            values = part.numbers(values)
            flat[..., start:stop] = values if offset is None else values.astype(np.int64) - offset
            start = stop
        return flat

    def _is_flat(self, observation: Any) -> bool:
        """Whether it is one array of the components of a nested space or of a Box of several axes."""
        if not isinstance(observation, np.ndarray) or observation.dtype.kind not in "iubf":
            return False
        shape = observation.shape
        nested = bool(self.parts[0].path)
        of_box = len(shape) <= 2 < len(self.parts[0].shape) + 1 and shape != self.parts[0].shape
        return (nested or of_box) and shape[-1:] == (self.size,) and len(shape) <= 2

    def to_json(self) -> str:
        """Returns the layout as a text, for a file."""
        return json.dumps([vars(part) for part in self.parts])

    @classmethod
    def from_json(cls, text: str) -> "Layout":
        """Returns the layout in a file, of which nothing is known.

        Raises:
            KeyError: if something is missing.
            ValueError: if it is not a layout.
        """
        parts = tuple(_restored(part) for part in json.loads(text))
        if not parts or not sum(part.size for part in parts):
            raise ValueError("its observations have no components")
        return cls(parts)


def _restored(stored: Any) -> Part:
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


def _parts(space: Any, whole: Any, path: tuple[str | int, ...]) -> Iterator[Part]:
    if isinstance(space, spaces.Dict):
        for key, part in space.spaces.items():
            yield from _parts(part, whole, (*path, key))
    elif isinstance(space, spaces.Tuple):
        for index, part in enumerate(space.spaces):
            yield from _parts(part, whole, (*path, index))
    else:
        yield _part(space, whole, path)


def _part(space: Any, whole: Any, path: tuple[str | int, ...]) -> Part:
    if not all(isinstance(key, str | int) for key in path):
        raise ValueError(f"the observation space must have texts as the keys of its Dict, got {path[-1]!r}")
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
