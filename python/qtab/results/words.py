"""States and actions in words: with the names that an environment, a map, or a call gives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils.shown import shown
from qtab.envs.metadata.quantities import Quantities
from qtab.results.axes import Axis, run_quantities
from qtab.results.run import Run

PLACES = ("red", "green", "yellow", "blue")


@dataclass(frozen=True)
class Names:
    """The names of a run's states and actions."""

    run: Run
    actions: tuple[str, ...]
    """The name of each action."""
    columns: int | None
    """The number of columns of the map of numbered states; None without a map."""

    @classmethod
    def of(
        cls, run: Run, env: gym.Env, columns: int | None = None, action_names: Sequence[str] | None = None
    ) -> "Names":
        """Returns the names that a call gives, or those of the environment, or the known ones."""
        known = own_action_names(env, run.action_names)
        return cls(run, checked_action_names(known, action_names), map_columns(env) if columns is None else columns)

    def state(self, observation: Any) -> str:
        """Returns an observation in words."""
        known = run_quantities(self.run.config, self.run.discretizer)
        low = self.run.discretizer.low
        return state_in_words(known, observation, self.columns, int(low) if low.ndim == 0 else 0)

    def cell(self, row: int) -> str:
        """Returns a row of the table in words."""
        return cell_in_words(self.run, row, self.columns)


def state_in_words(known: Quantities, observation: Any, columns: int | None = None, first: int = 0) -> str:
    """Returns an observation in words: its components by name, or its place on a map.

    Args:
        known: The names of the components.
        observation: The observation.
        columns: The number of columns of a map with numbered states; None without a map.
        first: The number of the first state of the map.
    """
    if columns is not None:
        row, column = divmod(int(observation) - first, columns)
        return f"row {row}, column {column}"
    if isinstance(observation, Mapping) or (isinstance(observation, tuple) and any(map(_has_parts, observation))):
        return _number(observation)
    if known.layout == "taxi" and np.ndim(observation) == 0:
        return _taxi(int(observation))
    numbers: Sequence[Any] = np.atleast_1d(np.asarray(observation)).tolist()
    named = known.observation
    if len(named) != len(numbers):
        return _number(observation)
    words = [one.values[number] if one.values else _number(number) for one, number in zip(named, numbers, strict=True)]
    return ", ".join(f"{one.name} {word}" for one, word in zip(named, words, strict=True))


def map_columns(env: gym.Env) -> int | None:
    """Returns the number of columns of a map whose cells are numbered row by row; None if there is no such map.

    The environment has it as ``nrow`` and ``ncol``, as ``shape``, or as ``layout``, rows of text.
    """
    unwrapped: Any = env.unwrapped
    rows, columns = getattr(unwrapped, "nrow", None), getattr(unwrapped, "ncol", None)
    shape = (rows, columns) if columns is not None else getattr(unwrapped, "shape", None)
    if shape is None and isinstance(layout := getattr(unwrapped, "layout", None), list | tuple) and layout:
        shape = (len(layout), len(layout[0])) if all(isinstance(row, str) for row in layout) else None
    space = env.observation_space
    if not isinstance(space, gym.spaces.Discrete) or not isinstance(shape, tuple) or len(shape) != 2:
        return None
    return int(shape[1]) if space.start == 0 and space.n == np.prod(shape) else None


def checked_action_names(known: tuple[str, ...], given: Sequence[str] | None) -> tuple[str, ...]:
    """Returns the names of actions: the given ones, or else the known ones.

    Raises:
        TypeError: if the given ones are not strings.
        ValueError: if there are too few or too many.
    """
    if given is None:
        return known
    if isinstance(given, str) or not all(isinstance(name, str) for name in given):
        raise TypeError(f"action_names must hold a name for each action, got {shown(given)}")
    if len(given) != len(known):
        raise ValueError(f"action_names must hold {len(known)} names, got {len(given)}")
    return tuple(given)


def numbered_states(run: Run) -> int:
    """Returns the number of states of a run whose observations are numbered states.

    Raises:
        ValueError: if they are not.
    """
    discretizer = run.discretizer
    if discretizer.low.ndim != 0 or len(discretizer.shape) != 1 or not discretizer.has_component_axes:
        raise ValueError(f"layout must be None for {run.config.env}, whose observations are not numbered states")
    return discretizer.n_rows


def own_action_names(env: gym.Env, known: tuple[str, ...]) -> tuple[str, ...]:
    """Returns the ``action_names`` that an environment has, or else the known names."""
    names = getattr(env.unwrapped, "action_names", None)
    fits = isinstance(names, list | tuple) and len(names) == len(known) and all(isinstance(one, str) for one in names)
    return tuple(names) if fits and names is not None else known


def cell_in_words(run: Run, row: int, columns: int | None = None) -> str:
    """Returns a row of a run's table in words: its place on a map, its state, or its bounds along each axis.

    Args:
        run: The run.
        row: The number of the row, from 0.
        columns: The number of columns of a map with numbered states; None without a map.
    """
    discretizer = run.discretizer
    if not discretizer.has_cells:
        return f"feature {row}" if discretizer.is_weighted else f"row {row}"
    if not discretizer.has_component_axes:
        return f"cell {row}"
    cell = [int(index) for index in np.unravel_index(row, discretizer.shape)]
    if discretizer.low.ndim == 0 and len(cell) == 1:
        first = int(discretizer.low)
        return state_in_words(run_quantities(run.config, discretizer), cell[0] + first, columns, first)
    return ", ".join(_within(axis, index) for axis, index in zip(run.axes, cell, strict=True))


def _within(axis: Axis, index: int) -> str:
    """Returns the bounds of a cell along an axis, or its integer."""
    if axis.values:
        return f"{axis.name} {axis.values[index]}"
    low, high = axis.edges[index], axis.edges[index + 1]
    if high - low == 1.0 and low % 1.0 == 0.5:  # the midpoints between integers
        return f"{axis.name} {low + 0.5:g}"
    return f"{axis.name} from {low:.4g} to {high:.4g}"


def _taxi(state: int) -> str:
    """Describes a state of Taxi, encoded as ((row * 5 + column) * 5 + passenger) * 4 + destination."""
    place, passenger, destination = state // 20, state // 4 % 5, state % 4
    where = f"at {PLACES[passenger]}" if passenger < len(PLACES) else "in the taxi"
    return f"taxi in row {place // 5}, column {place % 5}, passenger {where}, destination {PLACES[destination]}"


def _has_parts(value: Any) -> bool:
    return isinstance(value, Mapping | tuple) or np.ndim(value) > 0


def _number(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key}: {_number(part)}' for key, part in value.items())}}}"
    if isinstance(value, tuple):
        return f"({', '.join(map(_number, value))})"
    array = np.asarray(value)
    if array.ndim == 0:
        return f"{array.item():.6g}" if array.dtype.kind == "f" else str(array.item())
    return f"({', '.join(_number(part) for part in array)})"
