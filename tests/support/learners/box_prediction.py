"""Short predictions over the observations of a Box."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

CAR, POLE, PENDULUM = "MountainCar-v0", "CartPole-v1", "Pendulum-v1"
FAST: dict[str, Any] = {"learning_rate": 0.5, "episodes": 3, "record": 3, "max_episode_steps": 60}
TILES: dict[str, Any] = {"discretizer": "tiles", "tilings": 4, "tiles": 4}


def with_the_velocity(observation: NDArray[np.float32]) -> int:
    """Pushes MountainCar in the direction in which it moves."""
    return 0 if observation[1] < 0 else 2
