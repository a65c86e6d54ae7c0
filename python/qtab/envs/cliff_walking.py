"""``qtab/CliffWalking-v1`` and ``qtab/CliffWalkingSlippery-v1``."""

from gymnasium.envs.toy_text.cliffwalking import CliffWalkingEnv as GymnasiumCliffWalkingEnv

from qtab import _core


class CliffWalkingEnv(_core.Table, GymnasiumCliffWalkingEnv):
    """Gymnasium's CliffWalking stepping in Rust by its own table ``P``, as it stands at each step."""

    step_in_python = GymnasiumCliffWalkingEnv.step
