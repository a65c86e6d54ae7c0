"""The base class of discretizers, which map observations to the active rows of the Q table."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab._spec import DiscretizerSpec
from qtab._utils import html
from qtab._utils.memory import ALWAYS_FREE, free_memory, readable_size
from qtab._utils.shown import shown
from qtab.config import Config

MAX_SHOWN = 20
"""The maximum number of components of an observation to show in a notebook."""

MAX_TABLE_SIZE = 2**32
"""The limit of the number of values in a table: rows are numbered in 32 bits."""


@dataclass(frozen=True, eq=False, repr=False)
class Discretizer(ABC):
    """Maps the observations of a space to rows of the Q table. Rust computes the rows, here as in training."""

    low: NDArray[Any]
    """(d,): the lower bounds of the observation space, in its dtype; () for a Discrete space."""
    high: NDArray[Any]
    """(d,) or (): the upper bounds of the observation space."""

    reads_space: ClassVar[bool] = False
    """Whether :meth:`observe` must convert the observations of the environment for the extension."""
    flat_first: ClassVar[Sequence[int] | None] = None
    """The numbers that :meth:`observe` subtracts from the components of an observation, in the order of the space; None
    if it does more than that."""
    has_cells: ClassVar[bool] = True
    """Whether exactly one row, the cell of an observation, is active, so that the table has an axis per component."""
    is_weighted: ClassVar[bool] = False
    """Whether every row is active and has a number for an observation, by which a learner multiplies it."""
    is_time_aware: ClassVar[bool] = False
    """Whether the first axis is the number of steps taken in the episode."""
    has_component_axes: ClassVar[bool] = True
    """Whether the axes are the components of the observation, not the indices of a function or assigned rows."""

    def __repr__(self) -> str:
        """Returns one line: the number of cells along each component, or the number of rows."""
        if self.has_cells:
            cells = "1 cell" if self.n_rows == 1 else f"{' × '.join(f'{count:,}' for count in self.shape)} cells"
            return f"<{type(self).__name__}: {cells}>"
        return f"<{type(self).__name__}: {self.n_rows:,} rows, {self.n_active} of them active>"

    def _repr_html_(self) -> str:
        """Returns a table of the components of the observation, for notebooks."""
        edges = self.cell_edges()
        rows = [
            (index, f"{one[0]:.6g}", f"{one[-1]:.6g}", f"{len(one) - 1:,}") if len(one) else (index, "", "", "0")
            for index, one in enumerate(edges)
        ]
        cells = "cells" if self.has_cells else "tiles"
        return html.listing(repr(self)[1:-1], ("component", "from", "to", cells), rows[:MAX_SHOWN])

    @classmethod
    @abstractmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "Discretizer":
        """Returns the discretizer of an observation space.

        Args:
            space: The space.
            config: The config, with the defaults of its options filled in.
            n_actions: The number of values in a row of the table; 0 if the discretizer only finds cells, to which
                rows are then assigned.

        Raises:
            ValueError: if the space or an option does not fit, or the table would be too large.
        """

    @classmethod
    @abstractmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "Discretizer":
        """Returns the discretizer of a saved run, from the result of :meth:`arrays`.

        Args:
            config: The config in the file: complete, with each value valid by itself.
            arrays: The arrays in the file, unchecked.
            n_rows: The number of rows of the table in the file. No more memory than for such a table is allocated.

        Raises:
            KeyError: if an array is missing.
            ValueError: if the arrays do not fit the config.
        """

    @property
    @abstractmethod
    def shape(self) -> tuple[int, ...]:
        """The number of cells along each component of the observation; ``(n_rows,)`` without cells."""

    @abstractmethod
    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the ascending edges of the cells of each component of the observation; see :class:`qtab.Axis`."""

    @abstractmethod
    def spec(self) -> DiscretizerSpec:
        """Returns the discretizer as the extension takes it."""

    @property
    def n_rows(self) -> int:
        """The number of rows of the table."""
        return math.prod(self.shape)

    @property
    def n_active(self) -> int:
        """The number of rows that are active for an observation."""
        return 1

    def settings(self) -> dict[str, Any]:
        """Returns the settings derived from the space, for the config of the run."""
        return {}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Returns the arrays to save, from which :meth:`restore` rebuilds the discretizer."""
        return {"low": self.low, "high": self.high}

    @property
    def component_names(self) -> tuple[str, ...]:
        """A name for each component of the observation; empty to use the environment's own names."""
        return ()

    def observe(self, observation: Any) -> Any:
        """Returns an observation of the environment as the extension reads it."""
        return observation

    def along_axes(self, observation: Any) -> NDArray[Any]:
        """Returns (d,): the position of an observation along each axis of :meth:`cell_edges`."""
        return np.ravel(observation)

    def in_terms_of_space(self, message: str) -> str:
        """Translates a message of the extension about an observation to the names of the observation space."""
        return message

    def with_function(self, function: Callable[[Any], Any]) -> "Discretizer":  # noqa: ARG002
        """Returns the discretizer with ``function``, if it uses one."""
        return self

    def as_learned(self) -> "Discretizer":
        """Returns the discretizer in its current state, for a run that is made before the training is over."""
        return self

    def same_space(self, other: "Discretizer") -> bool:
        """Returns whether another discretizer has the same rows for observations between the same limits."""
        return (
            self.shape == other.shape and np.array_equal(self.low, other.low) and np.array_equal(self.high, other.high)
        )

    def active_rows(self, observation: Any) -> NDArray[np.int64]:
        """Returns the (n_active,) rows of an observation, or the (n, n_active) rows of n observations.

        With hashing a row can appear several times.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space).
            ValueError: if the observation does not have the shape of the space, or has no row.
        """
        return self._compiled.active_rows(observation)

    def active_features(self, observation: Any) -> NDArray[Any]:
        """Returns what a learner reads of one or n observations: the active rows, or values of weighted features."""
        return self.active_rows(observation)

    def split(self, observation: Any, count: int | None) -> list[Any]:
        """Splits a batch for :meth:`active_rows` into a list of ``count`` observations; None means a single one."""
        return [observation] if count is None else list(observation)

    def row(self, observation: Any) -> int:
        """Returns the row of the cell of one observation.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space).
            ValueError: if the observation does not have the shape of the space, or has no cell.
        """
        if not self.has_cells:
            raise ValueError(
                f"{type(self).__name__} has no cells; active_rows(observation) returns an observation's rows"
            )
        rows = self.active_rows(observation)
        if rows.ndim > 1:
            raise ValueError(f"observation must have shape {self.low.shape}, got {np.shape(observation)}")
        return int(rows[0])

    def cell(self, observation: Any) -> tuple[int, ...]:
        """Returns the index of one observation in ``run.q_table`` and ``run.policy``; see :meth:`row`."""
        return tuple(int(index) for index in np.unravel_index(self.row(observation), self.shape))

    @cached_property
    def _compiled(self) -> _core.Discretizer:
        return _core.Discretizer(self.spec())

    def __getstate__(self) -> dict[str, Any]:
        """Returns only the fields: the extension's object is rebuilt."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def check_table_size(name: str, given: Any, values: float, instead: str = "") -> None:
    """Raises an error for a table that is too large, before it is allocated.

    Args:
        name: The setting that determines the size.
        given: The value of the setting, or a text that describes it.
        values: The number of values that the table would have.
        instead: Another setting that would help, to be added to the message.

    Raises:
        ValueError: if the table has 2**32 values or more, or does not fit into memory.
    """
    if not values < MAX_TABLE_SIZE:
        many = f"{values:.3g}" if math.isfinite(values) else "more than 1e308"
        raise ValueError(
            f"{name} must give a table of fewer than 2**32 values{instead}, got {_text(given)}, which needs {many}"
        )
    needed = 8 * int(values)
    if needed < ALWAYS_FREE:
        return
    free = free_memory()
    try:
        # Some systems refuse at once; Linux overcommits memory, and kills the process that uses it.
        np.empty(needed, np.uint8)
    except MemoryError:
        free = min(free, needed - 1)
    if needed > free:
        raise ValueError(
            f"{name} must give a table that fits into memory{instead}, got {_text(given)}, which needs {values:.3g} "
            f"values or {readable_size(needed)}, more than is free"
        )


def _text(given: Any) -> str:
    return given if isinstance(given, str) else shown(given)
