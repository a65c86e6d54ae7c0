"""Sub-environments that are stepped in Python, one by one, as Gymnasium does it."""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import SyncVectorEnv

Portrait = tuple[dict[str, Any], int, bool, Any]
"""An environment's attributes, how many steps its episode has had, whether it is over, what it shows."""


class SubEnvironments(SyncVectorEnv[Any, Any]):
    """Gymnasium's ``SyncVectorEnv``, without a fault of its: what is a float stays one."""

    def go_on(
        self,
        portraits: Sequence[Portrait],
        unbegun: Sequence[int],
        generators: Sequence[np.random.Generator],
        seeds: Sequence[int],
    ) -> None:
        """Takes over where others stand, those never reset included."""
        for lane, portrait in enumerate(portraits):
            env = self.envs[lane]
            if lane not in unbegun:
                env.reset(seed=0)
                paint(env, portrait)
                _, _, self._autoreset_envs[lane], self._env_obs[lane] = portrait
            env.unwrapped._np_random = generators[lane]
            env.unwrapped._np_random_seed = seeds[lane]

    def _add_info(self, vector_infos: dict[str, Any], env_info: dict[str, Any], env_num: int) -> dict[str, Any]:
        # A table's probability is 1 after a reset, an integer; an array that begins with it would cut others.
        for name, value in env_info.items():
            array = vector_infos.get(name)
            if isinstance(value, float) and isinstance(array, np.ndarray) and array.dtype.kind == "i":
                vector_infos[name] = array.astype(np.float64)
        return super()._add_info(vector_infos, env_info, env_num)


def paint(env: gym.Env[Any, Any], portrait: Portrait) -> None:
    """Gives an environment that was reset the attributes of another."""
    attributes, elapsed, _, _ = portrait
    for name, value in attributes.items():
        setattr(env.unwrapped, name, value)
    if env.has_wrapper_attr("_elapsed_steps"):
        env.set_wrapper_attr("_elapsed_steps", elapsed)
