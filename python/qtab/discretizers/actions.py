"""The actions that an agent chooses from: those of a Discrete space, or a finite choice from a Box."""

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab._utils.shown import shown
from qtab.config import Config
from qtab.config.validation import MAX_ACTIONS

FLOATS = (np.dtype(np.float32), np.dtype(np.float64))
"""The dtypes of the Box spaces that qtab supports."""


@dataclass(frozen=True, repr=False)
class Actions:
    """The environment's actions, in the order of the columns of the Q table."""

    count: int
    first: int = 0
    """The number of the first action, where the action space is Discrete."""
    values: NDArray[np.floating] | None = None
    """(count, d) in the dtype of the space: the actions themselves, where the action space is a Box."""

    def __repr__(self) -> str:
        if self.values is None:
            return f"<Actions: {self.count}, numbered from {self.first}>"
        listed = shown(self.values.tolist() if self.values.shape[1:] != (1,) else self.values[:, 0].tolist())
        return f"<Actions: {self.count}, {listed}>"

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, index: int) -> Any:
        """Returns the action of a column as ``env.step`` takes it: an integer, or a new (d,) array."""
        if not 0 <= index < self.count:
            raise IndexError(f"there are {self.count} actions, got index {index}")
        return self.first + index if self.values is None else self.values[index].copy()

    def take(self, columns: NDArray[np.int64]) -> NDArray[Any]:
        """Returns the actions of many columns: integers of the same shape, or (..., d) where the space is a Box."""
        return columns + self.first if self.values is None else self.values[columns]

    def arrays(self) -> list[NDArray[np.floating]]:
        """Returns each action of a Box; an empty list for a Discrete space."""
        return [] if self.values is None else list(self.values)

    def match(self, config: Config) -> bool:
        """Whether these are the actions that a config asks for: what is read from a file may be anything."""
        values, wanted = self.values, config.actions
        if values is None or wanted is None:
            return values is None and wanted is None
        if values.dtype not in FLOATS or values.ndim != 2 or len(values) != self.count:
            return False
        if not np.isfinite(values).all():
            return False
        dimensions = values.shape[1]
        if isinstance(wanted, int):
            return dimensions > 0 and bool(len(values) == wanted**dimensions)
        return np.array_equal(np.array(wanted, values.dtype).reshape(-1, dimensions), values)


def choose_actions(space: Any, wanted: Any) -> Actions:
    """Returns the actions of a space; ``wanted`` is the config's ``actions``.

    Raises:
        ValueError: if the space is not supported, or ``wanted`` does not fit it.
    """
    if isinstance(space, spaces.Discrete):
        if wanted is not None:
            raise ValueError(f"actions applies to Box action spaces only, and this one is {space}; got {shown(wanted)}")
        return Actions(int(space.n), int(space.start))
    if not isinstance(space, spaces.Box) or len(space.shape) != 1 or space.dtype not in FLOATS:
        raise ValueError(
            f"the action space must be Discrete or a Box of one axis of float32 or float64, got {space}; "
            "gymnasium.wrappers.TransformAction makes one of it with a function"
        )
    if wanted is None:
        raise ValueError(
            f"actions must be given for the action space {space}: how many, in equal steps from its low to its high, "
            "or the actions themselves"
        )
    values = _equal_steps(space, wanted) if isinstance(wanted, int) else _listed(space, wanted)
    return Actions(len(values), values=values)


def _equal_steps(space: spaces.Box, count: int) -> NDArray[np.floating]:
    """Equal steps along each component, and every combination of them; the last component varies fastest."""
    if not (np.isfinite(space.low).all() and np.isfinite(space.high).all()):
        raise ValueError(f"actions must be the actions themselves where their space has no finite bounds: {space}")
    if count ** len(space.low) > MAX_ACTIONS:
        raise ValueError(f"actions must give at most {MAX_ACTIONS} actions, got {count} along each of {space.shape[0]}")
    steps: NDArray[Any] = np.linspace(space.low, space.high, count, dtype=space.dtype)
    return np.array(list(itertools.product(*steps.T)), dtype=space.dtype)


def _listed(space: spaces.Box, wanted: Any) -> NDArray[np.floating]:
    dimensions = space.shape[0]
    if any((len(action) if isinstance(action, tuple) else 1) != dimensions for action in wanted):
        raise ValueError(f"actions must hold {dimensions} numbers each for this action space, got {shown(wanted)}")
    if len(wanted) > MAX_ACTIONS:
        raise ValueError(f"actions must be at most {MAX_ACTIONS}, got {len(wanted)}")
    with np.errstate(over="ignore"):
        values: NDArray[Any] = np.array(wanted, dtype=space.dtype).reshape(-1, dimensions)
    if not ((space.low <= values) & (values <= space.high)).all():
        raise ValueError(f"actions must lie in the action space {space}, got {shown(wanted)}")
    return values
