"""The best known policy of MountainCar-v0, found by a search over the exact dynamics."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab import _core
from qtab.results.run import Run
from qtab.training.evaluate import evaluate

EVALUATION_EPISODES = 1000
"""The return of a greedy policy is estimated from this many episodes, with seed 0."""


@dataclass(frozen=True, eq=False)
class Search:
    """The routes and values that the search found. Every route reaches the goal; none is proven to be the shortest."""

    starts: NDArray[np.float64]
    """(1000,): start positions, the midpoints of equal parts of Gymnasium's range of start positions."""
    steps: NDArray[np.int64]
    """(1000,): the length of the route from each start; the time limit where no route was found."""
    routes: tuple[NDArray[np.uint8] | None, ...]
    """(1000,): the actions from each start, the last of which reaches the goal; None where no route was found."""
    predict_return: float
    """The mean return of :meth:`Optimum.predict` from the same starts. The routes may be a little shorter."""
    positions: NDArray[np.float64]
    """(positions,): the first axis of the grid of values."""
    velocities: NDArray[np.float64]
    """(velocities,): the second axis of the grid of values."""


KEPT_SEARCHES = 2
"""The results of so many searches are kept, about 50 MB each: ``gap`` after ``optimum`` need not search again."""


def search_mountain_car(
    constants: tuple[float, ...], max_episode_steps: int, on_values: Callable[[], None]
) -> tuple[_core.MountainCarSearch, Search]:
    """Searches the best policy of a MountainCar, or returns what the same search found before.

    Args:
        constants: The environment's, in the order of ``_core.parameter_names("MountainCar")``.
        max_episode_steps: The time limit in steps.
        on_values: Called between the two stages, when the values on the grid are known.
    """
    key = np.array(constants, np.float64).tobytes()  # -0.0 is not 0.0
    searched = _values(key, max_episode_steps)
    on_values()
    return searched, _routes(searched, max_episode_steps)


@lru_cache(KEPT_SEARCHES)
def _values(constants: bytes, max_episode_steps: int) -> _core.MountainCarSearch:
    numbers = np.frombuffer(constants).tolist()
    names = _core.parameter_names("MountainCar")
    return _core.MountainCarSearch(list(zip(names, numbers, strict=True)), max_episode_steps)


@lru_cache(KEPT_SEARCHES)
def _routes(searched: _core.MountainCarSearch, max_episode_steps: int) -> Search:
    """Searches a route from each start position."""
    starts, routes = searched.routes()
    steps = np.array([max_episode_steps if route is None else len(route) for route in routes], dtype=np.int64)
    predict_return = -float(searched.rollout_lengths().mean())
    found = Search(starts, steps, tuple(routes), predict_return, *searched.axes())
    shared: list[NDArray[Any]] = [starts, steps, found.positions, found.velocities]
    for array in shared + [route for route in routes if route is not None]:
        array.flags.writeable = False  # several optima share them
    return found


class MountainCarSolver:
    """Acts greedily with respect to the cost-to-go, and evaluates the policies of runs by simulation."""

    needs_step_count = False
    observation_shape = (2,)

    def __init__(self, searched: _core.MountainCarSearch) -> None:
        self._searched = searched

    def action(self, observation: ArrayLike, steps_taken: int) -> int:  # noqa: ARG002 - see needs_step_count
        """Returns the action with the smallest cost-to-go.

        Raises:
            ValueError: if the observation is not a finite position and velocity.
        """
        numbers = np.asarray(observation, dtype=np.float64)
        if numbers.shape != (2,) or not np.isfinite(numbers).all():
            raise ValueError(f"observation must be a position and a velocity, got {observation!r}")
        return self._searched.action(*numbers.tolist())

    def greedy_return(self, run: Run) -> tuple[float, float]:
        """Returns the mean return of a run's greedy policy over 1,000 episodes, and its standard error."""
        evaluation = evaluate(run, EVALUATION_EPISODES, seed=0, progress=False)
        return evaluation.mean_return, evaluation.standard_error
