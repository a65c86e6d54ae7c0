"""``qtab/Pendulum-v1``."""

from gymnasium.envs.classic_control.pendulum import PendulumEnv as GymnasiumPendulumEnv

from qtab.envs.physics import RustPhysics


class PendulumEnv(RustPhysics, GymnasiumPendulumEnv):
    """Gymnasium's Pendulum-v1 with its physics step in Rust, equal to the last bit."""

    model = "Pendulum"
