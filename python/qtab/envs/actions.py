"""The actions that an agent chooses from: all of a discrete space, or a finite choice from a Box."""

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab._utils.shown import counted, shown
from qtab.config import Config
from qtab.config.value_checks import MAX_ACTIONS

FLOATS = (np.dtype(np.float32), np.dtype(np.float64))
"""The dtypes of the Box spaces that qtab supports."""
_KINDS = "fiub"
"""The kinds of dtypes that the actions of a Box may have."""


@dataclass(frozen=True)
class ActionParts:
    """The actions of a Tuple or a Dict space, part by part."""

    parts: "tuple[Actions, ...]"
    """The actions of each part."""
    keys: tuple[str, ...] | None = None
    """The keys of a Dict space, in its order; None for a Tuple space."""

    def combine(self, values: Iterable[Any]) -> Any:
        """Returns one value for each part as a tuple or a dict."""
        return tuple(values) if self.keys is None else dict(zip(self.keys, values, strict=True))


@dataclass(frozen=True, repr=False)
class Actions:
    """The environment's actions, in the order of the columns of the Q table.

    Of several components every combination is an action, in C order: the last component varies fastest.
    """

    count: int
    first: int = 0
    """The number of the first action, where the action space is Discrete."""
    values: NDArray[Any] | None = None
    """(count, *shape) in the dtype of the space: the actions themselves, where they are arrays."""
    composite: ActionParts | None = None
    """Their parts, where the action space is a Tuple or a Dict."""

    def __repr__(self) -> str:
        if self.values is None:
            return f"<Actions: {self.count}, numbered from {self.first}>"
        listed = shown(self.values.tolist() if self.values.shape[1:] != (1,) else self.values[:, 0].tolist())
        return f"<Actions: {self.count}, {listed}>"

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, index: int) -> Any:
        """Returns the action of a column as ``env.step`` takes it.

        It is an integer for a Discrete space, a new array of the shape and the dtype of the space for a Box, a
        MultiDiscrete or a MultiBinary space, and a tuple or a dict of these for a Tuple or a Dict space.
        """
        if not 0 <= index < self.count:
            raise IndexError(f"there are {self.count} actions, got index {index}")
        if self.composite is not None:
            return self.composite.combine(
                part[int(number)] for part, number in zip(self.composite.parts, self._split(index), strict=True)
            )
        return self.first + index if self.values is None else np.array(self.values[index])

    def take(self, columns: NDArray[np.int64]) -> Any:
        """Returns the actions of many columns, as Gymnasium's vector environments take them.

        They are integers of the same shape, or (..., *shape) where the actions are arrays. Of a Tuple or a Dict space
        it is a tuple or a dict of these.
        """
        if self.composite is not None:
            return self.composite.combine(
                part.take(numbers) for part, numbers in zip(self.composite.parts, self._split(columns), strict=True)
            )
        return columns + self.first if self.values is None else self.values[columns]

    def _split(self, columns: Any) -> tuple[Any, ...]:
        """The columns of each part."""
        parts = () if self.composite is None else self.composite.parts
        return np.unravel_index(columns, [len(part) for part in parts])

    def objects(self) -> list[Any]:
        """Returns each action as ``env.step`` takes it; an empty list for a Discrete space."""
        if self.values is None and self.composite is None:
            return []
        return [self[index] for index in range(self.count)]

    def match(self, config: Config) -> bool:
        """Whether these are the actions that a config asks for: what is read from a file may be anything."""
        values, wanted = self.values, config.actions
        if values is None:
            return wanted is None
        if values.dtype.kind not in _KINDS or values.ndim < 1 or len(values) != self.count:
            return False
        if not np.isfinite(values).all():
            return False
        if wanted is None:
            return values.dtype.kind != "f"
        components = math.prod(values.shape[1:])
        if isinstance(wanted, int):
            return components > 0 and bool(len(values) == wanted**components)
        return np.array_equal(_array(wanted, values.dtype).reshape(-1, components), values.reshape(-1, components))


def choose_actions(space: Any, wanted: Any) -> Actions:
    """Returns the actions of a space; ``wanted`` is the config's ``actions``.

    Raises:
        ValueError: if the space is not supported or has too many actions, or ``wanted`` does not fit it.
    """
    if isinstance(space, spaces.Box) and space.dtype is not None and space.dtype.kind in _KINDS:
        return _of_box(space, wanted)
    if wanted is not None:
        raise ValueError(f"actions applies to Box action spaces only, and this one is {space}; got {shown(wanted)}")
    if isinstance(space, spaces.Discrete):
        return Actions(int(space.n), int(space.start))
    if isinstance(space, spaces.MultiDiscrete):
        return _all_integers(space, space.start, space.nvec)
    if isinstance(space, spaces.MultiBinary):
        return _all_integers(space, np.zeros(space.shape, np.int8), np.full(space.shape, 2))
    if isinstance(space, spaces.Tuple | spaces.Dict):
        return _of_parts(space)
    raise ValueError(
        "the action space must be Discrete, MultiDiscrete, MultiBinary, a Box of numbers, or a Tuple or Dict of "
        f"discrete spaces, got {space}; gymnasium.wrappers.TransformAction makes one of it with a function"
    )


def flat(action: Any) -> Sequence[Any]:
    """Returns the numbers of an action, whatever its structure, in order."""
    if isinstance(action, dict):
        return [number for part in action.values() for number in flat(part)]
    if isinstance(action, tuple):
        return [number for part in action for number in flat(part)]
    return action.ravel().tolist() if hasattr(action, "ravel") else [action]


def _of_parts(space: Any) -> Actions:
    keys = tuple(space.spaces) if isinstance(space, spaces.Dict) else None
    parts = []
    for part in space.spaces.values() if keys else space.spaces:
        if isinstance(part, spaces.Box) and part.dtype is not None and part.dtype.kind == "f":
            raise ValueError(
                f"the action space must hold only discrete spaces if it is a Tuple or a Dict, got {space}; "
                "gymnasium.wrappers.TransformAction makes another of it with a function"
            )
        parts.append(choose_actions(part, None))
    if not parts:
        raise ValueError(f"the action space must have at least one component, got {space}")
    count = math.prod(map(len, parts))
    _check_count(space, count)
    return Actions(count, composite=ActionParts(tuple(parts), keys))


def _of_box(space: spaces.Box, wanted: Any) -> Actions:
    if wanted is None:
        if space.dtype is not None and space.dtype.kind == "f":
            raise ValueError(
                f"actions must be given for the action space {space}: how many, in equal steps from its low to its "
                "high, or the actions themselves"
            )
        low = space.low.astype(object)
        return _all_integers(space, space.low, space.high.astype(object) - low + 1)
    values = _equal_steps(space, wanted) if isinstance(wanted, int) else _listed(space, wanted)
    return Actions(len(values), values=values.reshape(-1, *space.shape))


def _all_integers(space: Any, low: NDArray[Any], counts: NDArray[Any]) -> Actions:
    """Every combination of the integers of a space; the last component varies fastest."""
    sizes = [int(count) for count in np.ravel(counts)]
    count = math.prod(sizes)
    _check_count(space, count)
    if not sizes:
        raise ValueError(f"the action space must have at least one component, got {space}")
    offsets = np.stack(np.unravel_index(np.arange(count), sizes), axis=1)
    first = [int(number) for number in np.ravel(low)]
    values = np.array([[start + offset for start, offset in zip(first, row, strict=True)] for row in offsets.tolist()])
    return Actions(count, values=values.astype(space.dtype).reshape(-1, *space.shape))


def _check_count(space: Any, count: int) -> None:
    if count > MAX_ACTIONS:
        number = f"{count:,}" if count < 10**15 else f"{float(count):.3g}"
        fewer = "actions=" if isinstance(space, spaces.Box) else "gymnasium.wrappers.TransformAction"
        raise ValueError(
            f"the action space must have at most {MAX_ACTIONS} actions, got {space} with {number}; {fewer} can leave "
            "some out"
        )


def _equal_steps(space: spaces.Box, count: int) -> NDArray[Any]:
    """Equal steps along each component, and every combination of them; the last component varies fastest."""
    low, high = space.low.ravel(), space.high.ravel()
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise ValueError(f"actions must be the actions themselves where their space has no finite bounds: {space}")
    if count ** len(low) > MAX_ACTIONS:
        raise ValueError(f"actions must give at most {MAX_ACTIONS} actions, got {count} along each of {len(low)}")
    if space.dtype is not None and space.dtype.kind != "f":
        lengths = space.high.astype(object) - space.low.astype(object)
        if any(int(length) % (count - 1) for length in np.ravel(lengths)):
            raise ValueError(f"actions must give integers for the action space {space}, got {count} along each")
    steps: NDArray[Any] = np.linspace(low, high, count, dtype=space.dtype)
    return np.array(list(itertools.product(*steps.T)), dtype=space.dtype)


def _listed(space: spaces.Box, wanted: Any) -> NDArray[Any]:
    components = math.prod(space.shape)
    if any((len(action) if isinstance(action, tuple) else 1) != components for action in wanted):
        raise ValueError(
            f"actions must hold {counted(components, 'number')} each for this action space, got {shown(wanted)}"
        )
    if len(wanted) > MAX_ACTIONS:
        raise ValueError(f"actions must be at most {MAX_ACTIONS}, got {len(wanted)}")
    exact = np.array(wanted, np.float64).reshape(-1, components)
    if space.dtype is not None and space.dtype.kind != "f" and not (exact == np.floor(exact)).all():
        raise ValueError(f"actions must hold integers for the action space {space}, got {shown(wanted)}")
    if not ((space.low.ravel() <= exact) & (exact <= space.high.ravel())).all():
        raise ValueError(f"actions must lie in the action space {space}, got {shown(wanted)}")
    return _array(wanted, space.dtype).reshape(-1, components)


def _array(wanted: Any, dtype: Any) -> NDArray[Any]:
    with np.errstate(over="ignore", invalid="ignore"):
        return np.array(wanted, np.float64).astype(dtype)
