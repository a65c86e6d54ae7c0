"""``qtab/MountainCar-v0``."""

from gymnasium.envs.classic_control.mountain_car import MountainCarEnv as GymnasiumMountainCarEnv

from qtab.envs.physics import RustPhysics


class MountainCarEnv(RustPhysics, GymnasiumMountainCarEnv):
    """Gymnasium's MountainCar-v0 with its physics step in Rust, equal to the last bit."""

    model = "MountainCar"
