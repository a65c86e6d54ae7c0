"""Rows assigned when observations are first seen, for spaces with more cells than a table can have."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._spec import IdentitySpec
from qtab._utils.checks import required
from qtab.config import Config
from qtab.discretizers.base import Discretizer, check_table_size
from qtab.discretizers.composite import Composite
from qtab.discretizers.function import Function

_STORED = "met"
"""The name of the array of seen cells in files."""


@dataclass(frozen=True, eq=False, repr=False)
class AssignedRows(Discretizer):
    """A table of ``max_rows`` rows, which are assigned to cells in the order in which training first sees them.

    One additional row is never assigned: it keeps the initial values, and serves all cells that were not seen.
    """

    reads_space = True
    has_component_axes = False

    cells: Composite | Function
    """Finds the cell of an observation."""
    max_rows: int
    seen: dict[bytes, int] = field(repr=False)
    """The row of each seen cell, by the bytes of its int64 indices. Training adds cells; :meth:`as_learned` makes a
    copy."""
    assigns_rows: bool = True
    """Whether :meth:`observe` assigns a row to a cell that was not seen before."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "AssignedRows":
        """Returns a table without assigned rows.

        Raises:
            ValueError: if the space or an option does not fit, or the table would be too large.
        """
        max_rows = required("max_rows", config.max_rows)
        if n_actions:
            check_table_size("max_rows", max_rows, (max_rows + 1.0) * n_actions)
        cells = (Function if callable(config.discretizer) else Composite).build(space, config, 0)
        return cls._of(cells, max_rows, {})

    @classmethod
    def _of(cls, cells: Any, max_rows: int, seen: dict[bytes, int]) -> "AssignedRows":
        if isinstance(cells, Composite) and not cells.has_cells:
            raise ValueError("max_rows does not apply to discretizer 'tiles', which has no cells; hashed_rows= does")
        return cls(np.array(0), np.array(max_rows), cells, max_rows, seen)

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "AssignedRows":
        """Returns the table of a saved run; see :meth:`Discretizer.restore`."""
        max_rows = required("max_rows", config.max_rows)
        seen = arrays[_STORED]
        cells = (Function if callable(config.discretizer) else Composite).restore(config, arrays, n_rows)
        if n_rows != max_rows + 1 or seen.dtype != np.int64 or seen.ndim != 2 or len(seen) > max_rows:
            raise ValueError("its table has another number of rows than max_rows")
        rows = {cell.tobytes(): row for row, cell in enumerate(seen)}
        if len(rows) != len(seen) or (
            isinstance(cells, Composite) and seen.size and seen.shape[1] != cells.layout.size
        ):
            raise ValueError("its rows are not those of different cells")
        return cls._of(cells, max_rows, rows)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Returns the arrays to save."""
        seen = np.frombuffer(b"".join(self.seen), np.int64).reshape(len(self.seen), -1 if self.seen else 0)
        return {**self.cells.arrays(), _STORED: seen}

    def settings(self) -> dict[str, Any]:
        """Returns the settings derived from the space, for the config of the run."""
        return self.cells.settings()

    def as_learned(self) -> "AssignedRows":
        """Returns a copy with the rows assigned so far."""
        return replace(self, seen=dict(self.seen), assigns_rows=True)

    def with_function(self, function: Callable[[Any], Any]) -> "AssignedRows":
        """Returns the table with ``function``, if its discretizer is a function."""
        cells = self.cells
        return replace(self, cells=cells.with_function(function) if isinstance(cells, Function) else cells)

    def as_played(self) -> "AssignedRows":
        """Returns the table for a policy that only plays: all unseen cells share the last row."""
        return replace(self, assigns_rows=False)

    @property
    def n_seen(self) -> int:
        """The number of assigned rows."""
        return len(self.seen)

    @property
    def shape(self) -> tuple[int]:
        """The number of rows, plus one for unseen cells."""
        return (self.max_rows + 1,)

    @property
    def component_names(self) -> tuple[str, ...]:
        """The name of the only axis."""
        return ("row",)

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the midpoints between the row numbers."""
        return (np.arange(self.n_rows + 1.0) - 0.5,)

    def spec(self) -> IdentitySpec:
        """Returns the spec for the extension, whose observations are row numbers."""
        return {"type": "identity", "first": [0], "counts": [self.n_rows], "scalar": True}

    def observe(self, observation: Any) -> int:
        """Returns the row of an observation, a new one if its cell was not seen before.

        Raises:
            TypeError: if the observation does not hold numbers (integers for discrete spaces).
            ValueError: if the observation lies outside the space, or all rows are assigned.
        """
        cell = _key(self.cells.cells(observation))
        row = self.seen.get(cell)
        if row is None and not self.assigns_rows:
            return self.max_rows
        if row is None:
            row = len(self.seen)
            if row == self.max_rows:
                raise ValueError(
                    f"max_rows must be more than {row}: all rows are assigned, and training saw another observation"
                )
            first = next(iter(self.seen), cell)
            if len(cell) != len(first):
                raise ValueError(
                    "discretizer must return the same number of integers each time, "
                    f"got {len(first) // 8} and then {len(cell) // 8}"
                )
            self.seen[cell] = row
        return row

    def along_axes(self, observation: Any) -> NDArray[Any]:
        """Returns (1,): the row of an observation; the last row for an unseen cell."""
        return self.active_rows(observation)

    def active_rows(self, observation: Any) -> NDArray[np.int64]:
        """Returns the (1,) row of an observation, or the (n, 1) rows of n observations; the last row for unseen cells.

        Raises:
            TypeError: if the observation does not hold numbers (integers for discrete spaces).
            ValueError: if the observation does not have the shape of the space or lies outside it.
        """
        if isinstance(self.cells, Function):
            return self.cells.rows_by(self._known_row, observation)
        cells = self.cells.cells_of(observation)
        rows = [self.seen.get(_key(cell), self.max_rows) for cell in np.atleast_2d(cells)]
        return np.array(rows, np.int64).reshape(*cells.shape[:-1], 1)

    def split(self, observation: Any, count: int | None) -> list[Any]:
        """Returns a list of ``count`` observations; None means a single one."""
        return self.cells.split(observation, count)

    def _known_row(self, observation: Any) -> int:
        return self.seen.get(_key(self.cells.cells(observation)), self.max_rows)

    def same_space(self, other: Discretizer) -> bool:
        """Returns whether another discretizer has as many rows, for observations with the same components."""
        return isinstance(other, AssignedRows) and self.shape == other.shape and self.cells.same_space(other.cells)


def _key(cell: Any) -> bytes:
    return np.asarray(cell, np.int64).tobytes()
