"""The best known ways out of MountainCar's valley."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab import _core
from qtab.results.run import Run
from qtab.training.evaluate import evaluate

EVALUATED = 1000
"""So many episodes tell a greedy policy's return, seeded with 0."""


@dataclass(frozen=True, eq=False)
class Search:
    """What the search over the car's exact dynamics found. It is achieved, not proved to be the best."""

    starts: NDArray[np.float64]
    """(1000,): starting positions, the middles of equal shares of Gymnasium's range."""
    steps: NDArray[np.int64]
    """(1000,): how many steps it takes from each; the time limit where no way was found."""
    routes: tuple[NDArray[np.uint8] | None, ...]
    """(1000,): the actions from each start, the last of which reaches the goal; None where no way was found."""
    followed_return: float
    """The mean return of :meth:`Optimum.predict` from the same starts; the routes may be a little shorter."""
    positions: NDArray[np.float64]
    """(positions,): the grid of the values."""
    velocities: NDArray[np.float64]
    """(velocities,)"""


def search(valley: _core.Valley, limit: int) -> Search:
    """Searches a route from each start."""
    starts, routes = valley.routes()
    steps = np.array([limit if route is None else len(route) for route in routes], dtype=np.int64)
    followed = -float(valley.followed().mean())
    return Search(starts, steps, tuple(routes), followed, *valley.axes())


class ValleyTruth:
    """Decides by the cost-to-go."""

    remembers = False

    def __init__(self, valley: _core.Valley) -> None:
        self._valley = valley

    def action(self, observation: ArrayLike, taken: int) -> int:  # noqa: ARG002 - it does not matter here
        """Returns the action that the cost-to-go says is best.

        Raises:
            ValueError: for what is no position and velocity.
        """
        numbers = np.asarray(observation, dtype=np.float64)
        if numbers.shape != (2,) or not np.isfinite(numbers).all():
            raise ValueError(f"observation must be a position and a velocity, got {observation!r}")
        return self._valley.action(*numbers.tolist())

    def greedy_return(self, run: Run) -> tuple[float, float]:
        """Returns the mean return of a run's greedy policy over 1,000 episodes, and its standard error."""
        played = evaluate(run, EVALUATED, seed=0)
        return played.mean_return, played.standard_error
