"""Adds the number of steps taken to the cell of an observation, like Gymnasium's ``TimeAwareObservation``."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._spec import DiscretizerSpec
from qtab._utils.checks import required
from qtab.config import Config
from qtab.discretizers import named
from qtab.discretizers.base import Discretizer, check_table_size


@dataclass(frozen=True, eq=False, repr=False)
class TimeAware(Discretizer):
    """The cells of another discretizer, repeated for each step before the time limit. The axis of steps comes first.

    An observation does not hold the number of steps: :meth:`active_rows`, :meth:`row` and :meth:`cell` assume the
    start of an episode; :meth:`rows_after` takes any number of steps.
    """

    is_time_aware = True
    has_component_axes = False

    cells: Discretizer
    """Finds the cell of an observation."""
    max_episode_steps: int
    """The time limit, in steps."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "TimeAware":
        """Returns the cells of each step, over an observation space.

        Raises:
            ValueError: if the space or an option does not fit, or the table would be too large.
        """
        limit = required("max_episode_steps", config.max_episode_steps)
        cells = named.build(space, config, n_actions)
        size = f"True with {cells.n_rows:,} cells and {limit:,} steps"
        check_table_size("time_aware", size, float(cells.n_rows) * limit * n_actions)
        return cls(cells.low, cells.high, cells, limit)

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "TimeAware":
        """Returns the cells of a saved run; see :meth:`Discretizer.restore`."""
        limit = required("max_episode_steps", config.max_episode_steps)
        if n_rows % limit:
            raise ValueError("its table must have one row for each cell and step")
        cells = named.restore(config, arrays, n_rows // limit)
        return cls(cells.low, cells.high, cells, limit)

    @property
    def reads_space(self) -> bool:  # type: ignore[override]
        """Whether the cells must convert the observations of the environment for the extension."""
        return self.cells.reads_space

    @property
    def flat_first(self) -> Sequence[int] | None:  # type: ignore[override]
        """The numbers that :meth:`observe` subtracts from the components; None if it does more than that."""
        return self.cells.flat_first

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of steps, and the cells along each component of the observation."""
        return (self.max_episode_steps, *self.cells.shape)

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the midpoints between the steps, and the edges of the cells."""
        return (np.arange(self.max_episode_steps + 1.0) - 0.5, *self.cells.cell_edges())

    @property
    def component_names(self) -> tuple[str, ...]:
        """The names of the components of the observation, if the cells have any."""
        return self.cells.component_names

    def spec(self) -> DiscretizerSpec:
        """Returns the spec of the cells, as the extension takes it; the extension counts the steps."""
        return self.cells.spec()

    def settings(self) -> dict[str, Any]:
        """Returns the settings derived from the space, for the config of the run."""
        return self.cells.settings()

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Returns the arrays to save."""
        return self.cells.arrays()

    def observe(self, observation: Any) -> Any:
        """Returns an observation of the environment as the extension reads it."""
        return self.cells.observe(observation)

    def along_axes(self, observation: Any) -> NDArray[Any]:
        """Returns (1 + d,): step 0, and the position of an observation along each axis of its components."""
        return np.concatenate([[0], self.cells.along_axes(observation)])

    def in_terms_of_space(self, message: str) -> str:
        """Translates a message of the extension about an observation to the names of the observation space."""
        return self.cells.in_terms_of_space(message)

    def with_function(self, function: Callable[[Any], Any]) -> "TimeAware":
        """Returns the discretizer with ``function``, if it uses one."""
        return replace(self, cells=self.cells.with_function(function))

    def same_space(self, other: Discretizer) -> bool:
        """Returns whether another discretizer has the same rows for observations of the same shape."""
        return isinstance(other, TimeAware) and self.shape == other.shape and self.cells.same_space(other.cells)

    def active_rows(self, observation: Any) -> NDArray[np.int64]:
        """Returns the (1,) row of an observation at the start of an episode, or the (n, 1) rows of n observations.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space).
            ValueError: if the observation does not have the shape of the space, or has no row.
        """
        return self.cells.active_rows(observation)

    def split(self, observation: Any, count: int | None) -> list[Any]:
        """Returns a list of ``count`` observations; None means a single one."""
        return self.cells.split(observation, count)

    def rows_after(self, steps: Any, observation: Any) -> NDArray[np.int64]:
        """Returns the (1,) row of an observation after a number of steps, or the (n, 1) rows of n observations.

        Args:
            steps: The number of steps taken in the episode, or (n,) numbers. From the time limit on, when no action is
                taken, the rows are those of the last step.
            observation: An observation, or n of them.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space).
            ValueError: if the observation does not have the shape of the space, or has no row; or if ``steps`` does not
                fit the observations.
        """
        rows = self.cells.active_rows(observation)
        taken = np.minimum(np.asarray(steps, np.int64), self.max_episode_steps - 1)
        if taken.size == 1:
            taken = taken.reshape(())
        elif taken.shape != rows.shape[:-1]:
            count = "the observation" if rows.ndim == 1 else f"each of the {len(rows)} observations"
            raise ValueError(f"state must hold a number of steps for {count}, got {taken.shape} of them")
        moved: NDArray[np.int64] = rows + (taken[..., np.newaxis] * self.cells.n_rows)
        return moved
