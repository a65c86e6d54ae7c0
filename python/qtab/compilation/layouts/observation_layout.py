"""The observations of a space as numbers in memory, and the code that writes them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab.compilation.interface.qtab_env import FLOAT32, FLOAT64, INT64
from qtab.compilation.not_compilable import NotCompilable


@dataclass(frozen=True, eq=False)
class ObservationPart:
    """A space without subspaces."""

    path: tuple[int, ...]
    """The indices of the part in an observation, a nesting of tuples."""
    shape: tuple[int, ...]
    kind: str
    """``"float32"``, ``"float64"`` or ``"int64"``."""
    low: NDArray[np.float64]
    """(numbers,): the lowest values."""
    high: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ObservationLayout:
    """The numbers of an observation, those of its parts in the order of the space and in C order."""

    parts: tuple[ObservationPart, ...]

    @classmethod
    def of(cls, space: Any) -> "ObservationLayout":
        """Returns the layout of the observations of a space.

        Raises:
            NotCompilable: if compiled code cannot write them.
        """
        layout = cls(tuple(_parts(space, ())))
        if not layout.size:
            raise NotCompilable(f"the observation space has no numbers: {space}")
        return layout

    @property
    def size(self) -> int:
        """The number of numbers."""
        return sum(len(part.low) for part in self.parts)

    @property
    def type(self) -> int:
        """The type of the numbers: of all the same, or float64."""
        kinds = {part.kind for part in self.parts}
        return {"float32": FLOAT32, "int64": INT64}.get(kinds.pop(), FLOAT64) if len(kinds) == 1 else FLOAT64

    @property
    def dtype(self) -> np.dtype[Any]:
        """The dtype of the numbers."""
        return np.dtype({FLOAT32: np.float32, FLOAT64: np.float64, INT64: np.int64}[self.type])

    @property
    def low(self) -> NDArray[np.float64]:
        """(size,): the lowest values."""
        return np.concatenate([part.low for part in self.parts])

    @property
    def high(self) -> NDArray[np.float64]:
        """(size,): the highest values."""
        return np.concatenate([part.high for part in self.parts])

    def numbers(self, observation: Any) -> NDArray[Any]:
        """Returns (size,): the numbers of an observation of the space, in Python."""
        found = [np.ravel(value) for value in _flat(observation)]
        return np.concatenate(found).astype(self.dtype)


def _flat(observation: Any) -> Iterator[Any]:
    if isinstance(observation, dict | tuple):
        for part in observation.values() if isinstance(observation, dict) else observation:
            yield from _flat(part)
    else:
        yield observation


def _parts(space: Any, path: tuple[int, ...]) -> Iterator[ObservationPart]:
    if isinstance(space, spaces.Tuple | spaces.Dict):
        parts = space.spaces.values() if isinstance(space, spaces.Dict) else space.spaces
        for index, part in enumerate(parts):
            yield from _parts(part, (*path, index))
        return
    if isinstance(space, spaces.Discrete):
        lowest = float(space.start)
        yield _part(path, (), "int64", [lowest], [lowest + float(space.n) - 1])
    elif isinstance(space, spaces.MultiDiscrete):
        first = np.broadcast_to(space.start, space.nvec.shape)
        yield _part(path, space.nvec.shape, "int64", first, first + space.nvec - 1)
    elif isinstance(space, spaces.MultiBinary):
        yield _part(path, space.shape, "int64", np.zeros(space.shape), np.ones(space.shape))
    elif isinstance(space, spaces.Box) and space.dtype in (np.float32, np.float64):
        yield _part(path, space.shape, str(space.dtype), space.low, space.high)
    elif isinstance(space, spaces.Box) and space.dtype is not None and space.dtype.kind in "biu":
        low, high = space.low.astype(np.float64), space.high.astype(np.float64)
        if max(np.abs(low).max(initial=0), np.abs(high).max(initial=0)) > 2.0**53:
            raise NotCompilable(f"the bounds of the observation space are beyond 2**53: {space}")
        yield _part(path, space.shape, "int64", low, high)
    else:
        raise NotCompilable(f"observations of {' '.join(str(space).split())} cannot be compiled")


def _part(path: tuple[int, ...], shape: Any, kind: str, low: Any, high: Any) -> ObservationPart:
    bounds = (np.asarray(bound, np.float64).reshape(-1) for bound in (low, high))
    return ObservationPart(path, tuple(map(int, shape)), kind, *bounds)
