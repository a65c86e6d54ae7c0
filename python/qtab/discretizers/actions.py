"""What a learner chooses from: the actions of a Discrete space, or a few of a continuous one."""

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab.config.validation import MAX_ACTIONS

FLOATS = (np.dtype(np.float32), np.dtype(np.float64))
"""The dtypes of the boxes that qtab knows."""


@dataclass(frozen=True)
class Actions:
    """So many actions, by the numbers that the columns of a table have."""

    count: int
    first: int = 0
    """The environment's own number of the first, where its space is Discrete."""
    values: NDArray[np.floating] | None = None
    """(count, d) in the space's dtype: the actions themselves, where its space is a Box."""

    def __getitem__(self, index: int) -> Any:
        """What the environment's step takes: an integer, or a (d,) array of its own."""
        return self.first + index if self.values is None else self.values[index].copy()

    def greedy(self, indices: NDArray[np.int64]) -> NDArray[Any]:
        """Returns the environment's actions in the place of their numbers; where it is a Box, with an axis more."""
        return indices + self.first if self.values is None else self.values[indices]

    def arrays(self) -> list[NDArray[np.floating]]:
        """Returns each action of a Box; none of a Discrete space."""
        return [] if self.values is None else list(self.values)


def actions(space: Any, wanted: Any) -> Actions:
    """Returns what a learner chooses from; ``wanted`` is the config's ``actions``.

    Raises:
        ValueError: if the space does not fit, or what is wanted does not fit the space; it says what would.
    """
    if isinstance(space, spaces.Discrete):
        if wanted is not None:
            raise ValueError(f"actions must be left out where the action space is Discrete, got {wanted!r}")
        return Actions(int(space.n), int(space.start))
    if not isinstance(space, spaces.Box) or len(space.shape) != 1 or space.dtype not in FLOATS:
        raise ValueError(f"the action space must be Discrete or a Box of one float axis, got {space}")
    if wanted is None:
        raise ValueError(
            f"actions must be given for the action space {space}: how many, in equal steps from its low to its high, "
            "or the actions themselves"
        )
    values = _steps(space, wanted) if isinstance(wanted, int) else _listed(space, wanted)
    return Actions(len(values), values=values)


def _steps(space: spaces.Box, count: int) -> NDArray[np.floating]:
    """Equal steps along each component, every combination of them, the last component running fastest."""
    if not (np.isfinite(space.low).all() and np.isfinite(space.high).all()):
        raise ValueError(f"actions must be the actions themselves where their space has no finite bounds: {space}")
    if count ** len(space.low) > MAX_ACTIONS:
        raise ValueError(f"actions must give at most {MAX_ACTIONS} actions, got {count} along each of {space.shape[0]}")
    steps: NDArray[Any] = np.linspace(space.low, space.high, count, dtype=space.dtype)
    return np.array(list(itertools.product(*steps.T)), dtype=space.dtype)


def _listed(space: spaces.Box, wanted: Any) -> NDArray[np.floating]:
    components = space.shape[0]
    if any((len(action) if isinstance(action, tuple) else 1) != components for action in wanted):
        raise ValueError(f"actions must hold {components} numbers each for this action space, got {wanted!r}")
    if len(wanted) > MAX_ACTIONS:
        raise ValueError(f"actions must be at most {MAX_ACTIONS}, got {len(wanted)}")
    with np.errstate(over="ignore"):
        values: NDArray[Any] = np.array(wanted, dtype=space.dtype).reshape(-1, components)
    if not ((space.low <= values) & (values <= space.high)).all():
        raise ValueError(f"actions must lie in the action space {space}, got {wanted!r}")
    return values
