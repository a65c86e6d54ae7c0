"""``qtab/MountainCarContinuous-v0``."""

from gymnasium.envs.classic_control.continuous_mountain_car import (
    Continuous_MountainCarEnv as GymnasiumContinuousMountainCarEnv,
)

from qtab.envs.physics import RustPhysics


class ContinuousMountainCarEnv(RustPhysics, GymnasiumContinuousMountainCarEnv):
    """Gymnasium's MountainCarContinuous-v0 with its physics step in Rust, equal to the last bit."""

    model = "ContinuousMountainCar"
