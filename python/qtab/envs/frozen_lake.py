"""``qtab/FrozenLake-v1`` and ``qtab/FrozenLake8x8-v1``."""

from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv as GymnasiumFrozenLakeEnv

from qtab import _core


class FrozenLakeEnv(_core.Table, GymnasiumFrozenLakeEnv):
    """Gymnasium's FrozenLake stepping in Rust by its own table ``P``, as it stands at each step."""

    step_in_python = GymnasiumFrozenLakeEnv.step
