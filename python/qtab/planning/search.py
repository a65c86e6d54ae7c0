"""``qtab.planning.search.Search``: the results of a search in classic control."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Search:
    """Episodes of the best known policy, and the grid of its values. No episode is proven optimal."""

    starts: NDArray[np.float64]
    """(starts,) the start positions of MountainCar; (starts, components) start states of the other environments. They
    cover Gymnasium's range of start states evenly."""
    steps: NDArray[np.int64]
    """(starts,): the length of the episode from each start."""
    returns: NDArray[np.float64]
    """(starts,): the undiscounted return of the episode from each start."""
    routes: tuple[NDArray[np.uint8] | None, ...]
    """(starts,): the actions from each start, the last of which reaches the goal. None if no route was found, and for
    CartPole and Pendulum, which have no goal: their episodes follow :meth:`qtab.Optimum.predict`."""
    predict_return: float
    """The mean return of :meth:`qtab.Optimum.predict` from the same starts. The routes may be slightly better."""
    axes: tuple[NDArray[np.float64], ...]
    """The coordinates of the grid along each component of a state: for MountainCar position and velocity, for CartPole
    position, velocity, angle and angular velocity, for Pendulum angle and angular velocity, for Acrobot both angles and
    both angular velocities."""

    @property
    def positions(self) -> NDArray[np.float64]:
        """(positions,): the first axis of the grid."""
        return self.axes[0]

    @property
    def velocities(self) -> NDArray[np.float64]:
        """(velocities,): the second axis of the grid."""
        return self.axes[1]
