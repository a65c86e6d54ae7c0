"""A vector environment whose sub-environments Python steps one by one, like Gymnasium's ``SyncVectorEnv``."""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.toy_text.taxi import TaxiEnv
from gymnasium.spaces import Box, Dict, Tuple
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.vector.utils import iterate
from numpy.typing import NDArray

from qtab import _core
from qtab.envs.external.positions import Position, generator_at, position_of

Snapshot = tuple[dict[str, Any], int, bool, Any]
"""State of a sub-environment: its attributes, the steps of its episode, whether that is over, the last observation."""


class PythonVectorEnv(SyncVectorEnv[Any, Any]):
    """Gymnasium's ``SyncVectorEnv`` with two differences.

    All actions are checked before any sub-environment steps, and an info that is a float stays a float64.
    """

    def step(
        self, actions: Any
    ) -> tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Steps every sub-environment after checking all actions.

        Raises:
            AssertionError: for an action outside the space, or a step after the end of an episode without a
                reset.
            ValueError: for the wrong number of actions, or a continuous action that is not one finite number.
        """
        self._check_actions(actions)
        observations, rewards, terminations, truncations, infos = super().step(actions)
        if "prob" in infos:
            infos["prob"] = infos["prob"].astype(np.float64)
        return observations, rewards, terminations, truncations, infos

    def not_reset(self) -> list[int]:
        """Returns the indices of the sub-environments that were never reset."""
        return [index for index, observation in enumerate(self._env_obs) if observation is None]

    def _check_actions(self, actions: Any) -> None:
        awaits_reset = self._autoreset_envs
        if self.autoreset_mode is AutoresetMode.DISABLED and awaits_reset.any():
            index = int(np.argmax(awaits_reset))
            raise AssertionError(
                f"the episode of sub-environment {index} is over: reset it first, with options={{'reset_mask': ...}}"
            )
        if not isinstance(self.action_space, Dict | Tuple) and len(actions) != self.num_envs:
            raise ValueError(f"actions must have shape {self.action_space.shape}, got {len(actions)} of them")
        for index, action in enumerate(iterate(self.action_space, actions)):
            if self.autoreset_mode is AutoresetMode.NEXT_STEP and awaits_reset[index]:
                continue  # this step resets it and ignores the action
            if isinstance(self.single_action_space, Box) and self.single_action_space.shape == (1,):
                if np.shape(action) != (1,) or not np.isfinite(action).all():
                    raise ValueError(f"actions[{index}] must be a finite number, got {action}")
            elif not self.single_action_space.contains(action):
                raise AssertionError(f"sub-environment {index}: {action!r} ({type(action)}) invalid")

    def resume_from(
        self,
        snapshots: Sequence[Snapshot],
        not_reset: Sequence[int],
        generators: Sequence[np.random.Generator],
        seeds: Sequence[int],
    ) -> None:
        """Continues the episodes of other sub-environments.

        Args:
            snapshots: The state of each.
            not_reset: The indices of those that were never reset.
            generators: The random generator of each.
            seeds: The seed of each generator.
        """
        for index, snapshot in enumerate(snapshots):
            env = self.envs[index]
            if index not in not_reset:
                env.reset(seed=0)
                restore(env, snapshot)
                _, _, self._autoreset_envs[index], self._env_obs[index] = snapshot
            env.unwrapped._np_random = generators[index]
            env.unwrapped._np_random_seed = seeds[index]

    def play_again(
        self,
        snapshots: Sequence[Snapshot],
        not_reset: Sequence[int],
        positions: Sequence[Position],
        seeds: Sequence[int],
    ) -> None:
        """Continues the episodes of other sub-environments, which are played again from their resets on.

        Args:
            snapshots: Those of each: the attribute ``played`` is the position of the generator before the reset, and
                the actions since then, counted from 0.
            not_reset: The indices of those that were never reset.
            positions: The position of each generator now.
            seeds: The seed of each generator.

        Raises:
            RuntimeError: if an episode draws other random numbers now.
        """
        first = int(self.single_action_space.start)  # type: ignore[attr-defined]
        for index, (attributes, _, is_done, _) in enumerate(snapshots):
            env, seed = self.envs[index], seeds[index]
            start, actions = (positions[index], []) if index in not_reset else attributes["played"]
            unwrapped: Any = env.unwrapped
            unwrapped._np_random, unwrapped._np_random_seed = generator_at(seed, start), seed
            if index in not_reset:
                continue
            self._env_obs[index], _ = env.reset()
            for action in actions:
                self._env_obs[index], *_ = env.step(np.int64(first + action))
            if position_of(unwrapped._np_random, seed) != positions[index]:
                name = type(unwrapped).__name__
                raise RuntimeError(f"{name} draws other random numbers in compiled code than in Python")
            self._autoreset_envs[index] = is_done

    def _add_info(self, vector_infos: dict[str, Any], env_info: dict[str, Any], env_num: int) -> dict[str, Any]:
        # The probability is the integer 1 after a reset. An array of integers would truncate the probabilities that
        # other sub-environments add.
        for name, value in env_info.items():
            array = vector_infos.get(name)
            if isinstance(value, float) and isinstance(array, np.ndarray) and array.dtype.kind == "i":
                vector_infos[name] = array.astype(np.float64)
        return super()._add_info(vector_infos, env_info, env_num)


def generators(envs: _core.VectorEnv, num_envs: int) -> tuple[np.random.Generator, ...]:
    """Returns the generators of sub-environments that Rust steps, from which these draw from now on."""
    found = []
    for index in range(num_envs):
        source = envs.rng(index)
        if isinstance(source, tuple):
            source = generator_at(envs.seed_of(index), source)
            envs.set_rng(index, source)
        found.append(source)
    return tuple(found)


def draws_its_state(env: gym.Env) -> bool:
    """Returns whether a frame depends on nothing but the state."""
    return type(env).__module__.startswith("qtab.") and not isinstance(env, TaxiEnv)


def restore(env: gym.Env[Any, Any], snapshot: Snapshot) -> None:
    """Sets the attributes and the step count of an environment, which must have been reset, to those of a snapshot."""
    attributes, elapsed_steps, _, _ = snapshot
    for name, value in attributes.items():
        setattr(env.unwrapped, name, value)
    if env.has_wrapper_attr("_elapsed_steps"):
        env.set_wrapper_attr("_elapsed_steps", elapsed_steps)
