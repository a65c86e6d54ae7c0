"""``qtab/CartPole-v1`` and ``qtab/CartPole-v0``."""

from gymnasium.envs.classic_control.cartpole import CartPoleEnv as GymnasiumCartPoleEnv

from qtab.envs.physics import RustPhysics


class CartPoleEnv(RustPhysics, GymnasiumCartPoleEnv):
    """Gymnasium's CartPole with its physics step in Rust, equal to the last bit."""

    model = "CartPole"
