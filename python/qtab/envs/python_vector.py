"""Sub-environments that are stepped in Python, one by one, as Gymnasium does it."""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Discrete
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.vector.utils import iterate
from numpy.typing import NDArray

Portrait = tuple[dict[str, Any], int, bool, Any]
"""An environment's attributes, how many steps its episode has had, whether it is over, what it shows."""


class SubEnvironments(SyncVectorEnv[Any, Any]):
    """Gymnasium's ``SyncVectorEnv``, but what is a float stays one, and bad actions move nobody."""

    def step(
        self, actions: Any
    ) -> tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Steps each, once all actions were looked at.

        Raises:
            AssertionError: for an action outside a discrete space, or an episode that is over and was not reset.
            ValueError: for a wrong number of actions, or one that is no finite number.
        """
        self._look_at(actions)
        observations, rewards, terminations, truncations, infos = super().step(actions)
        if "prob" in infos:
            infos["prob"] = infos["prob"].astype(np.float64)
        return observations, rewards, terminations, truncations, infos

    def unbegun(self) -> list[int]:
        """Returns which were never reset."""
        return [lane for lane, observation in enumerate(self._env_obs) if observation is None]

    def _look_at(self, actions: Any) -> None:
        waiting = self._autoreset_envs
        if self.autoreset_mode is AutoresetMode.DISABLED and waiting.any():
            lane = int(np.argmax(waiting))
            raise AssertionError(
                f"the episode of sub-environment {lane} is over: reset it first, with options={{'reset_mask': ...}}"
            )
        if len(actions) != self.num_envs:
            raise ValueError(f"actions must have shape {self.action_space.shape}, got {len(actions)} of them")
        for lane, action in enumerate(iterate(self.action_space, actions)):
            if self.autoreset_mode is AutoresetMode.NEXT_STEP and waiting[lane]:
                continue
            if not isinstance(self.single_action_space, Discrete):
                if np.shape(action) != (1,) or not np.isfinite(action).all():
                    raise ValueError(f"actions[{lane}] must be a finite number, got {action}")
            elif not self.single_action_space.contains(action):
                raise AssertionError(f"sub-environment {lane}: {action!r} ({type(action)}) invalid")

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
