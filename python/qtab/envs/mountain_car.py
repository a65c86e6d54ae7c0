"""``qtab/MountainCar-v0``."""

from typing import Any

from gymnasium.envs.classic_control.mountain_car import MountainCarEnv as GymnasiumMountainCarEnv

from qtab.envs.physics import Parameter, RustPhysics


class MountainCarEnv(RustPhysics, GymnasiumMountainCarEnv):
    """Gymnasium's MountainCar-v0 with its physics step in Rust, equal to the last bit.

    Spaces, reset, reset options and rendering are Gymnasium's own. What Gymnasium lets a user assign is honoured:
    ``state`` and each of the constants below.
    """

    model = "MountainCar"
    min_position: Any = Parameter()
    max_position: Any = Parameter()
    max_speed: Any = Parameter()
    goal_position: Any = Parameter()
    goal_velocity: Any = Parameter()
    force: Any = Parameter()
    gravity: Any = Parameter()
