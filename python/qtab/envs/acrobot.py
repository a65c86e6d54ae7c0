"""``qtab/Acrobot-v1``."""

from gymnasium.envs.classic_control.acrobot import AcrobotEnv as GymnasiumAcrobotEnv

from qtab.envs.physics import RustPhysics


class AcrobotEnv(RustPhysics, GymnasiumAcrobotEnv):
    """Gymnasium's Acrobot-v1 with its physics step in Rust, equal to the last bit."""

    model = "Acrobot"
