"""``qtab/FrozenLake-v1`` and ``qtab/FrozenLake8x8-v1``."""

from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv as GymnasiumFrozenLakeEnv

from qtab import _core
from qtab.envs.toy_text import RustReset


class FrozenLakeEnv(_core.Table, RustReset, GymnasiumFrozenLakeEnv):
    """Gymnasium's FrozenLake stepping in Rust by its own table ``P``, as it stands at each step."""

    reset_in_python = GymnasiumFrozenLakeEnv.reset
    step_in_python = GymnasiumFrozenLakeEnv.step
