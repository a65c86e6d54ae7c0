"""``qtab/CliffWalking-v1`` and ``qtab/CliffWalkingSlippery-v1``."""

from gymnasium.envs.toy_text.cliffwalking import CliffWalkingEnv as GymnasiumCliffWalkingEnv

from qtab import _core
from qtab.envs.toy_text import RustReset


class CliffWalkingEnv(_core.Table, RustReset, GymnasiumCliffWalkingEnv):
    """Gymnasium's CliffWalking stepping in Rust by its own table ``P``, as it stands at each step."""

    reset_in_python = GymnasiumCliffWalkingEnv.reset
    step_in_python = GymnasiumCliffWalkingEnv.step
