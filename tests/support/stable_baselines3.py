"""The parts of Stable-Baselines3's ``VecEnv`` that a subclass relies on, for tests without PyTorch.

They follow the documentation of Stable-Baselines3 2.9. ``pytest -m sb3`` tests with the library itself.
"""

import sys
from collections.abc import Iterable
from types import ModuleType
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

_MODULES = ("stable_baselines3", "common", "vec_env", "base_vec_env")


class VecEnv:
    """The base class: seeds and options are kept for the next reset."""

    def __init__(self, num_envs: int, observation_space: Any, action_space: Any) -> None:
        self.num_envs = num_envs
        self.observation_space = observation_space
        self.action_space = action_space
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(num_envs)]
        self._reset_seeds()
        self._reset_options()
        self.render_mode = self.get_attr("render_mode")[0]
        self.metadata: dict[str, Any] = {}

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        raise NotImplementedError  # abstract, as in Stable-Baselines3: the class under test implements it

    def _reset_seeds(self) -> None:
        self._seeds: list[int | None] = [None] * self.num_envs

    def _reset_options(self) -> None:
        self._options: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]

    def seed(self, seed: int) -> None:
        self._seeds = [seed + index for index in range(self.num_envs)]

    def set_options(self, options: Any) -> None:
        self._options = [options] * self.num_envs if isinstance(options, dict) else options

    def has_attr(self, attr_name: str) -> bool:
        try:
            self.get_attr(attr_name)
        except AttributeError:
            return False
        return True

    def _get_indices(self, indices: int | Iterable[int] | None) -> Iterable[int]:
        if indices is None:
            return range(self.num_envs)
        return [indices] if isinstance(indices, int) else indices


def install(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets ``qtab.sb3`` import the class above in place of Stable-Baselines3, until the test is over."""
    for depth in range(1, len(_MODULES) + 1):
        name = ".".join(_MODULES[:depth])
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    sys.modules[".".join(_MODULES)].VecEnv = VecEnv  # type: ignore[attr-defined]
    monkeypatch.delitem(sys.modules, "qtab.sb3.vec_env", raising=False)


class OneByOne:
    """What ``DummyVecEnv`` documents: one environment after the other, each reset at once where its episode ends."""

    def __init__(self, name: str, num_envs: int, **kwargs: Any) -> None:
        self.envs = [gym.make(name, **kwargs) for _ in range(num_envs)]
        self.reset_infos: list[dict[str, Any]] = []

    def batch(self, observations: list[Any]) -> Any:
        if isinstance(observations[0], tuple):
            return tuple(np.array(column) for column in zip(*observations, strict=True))
        return np.array(observations)

    def reset(self, seed: int | None, options: list[dict[str, Any]] | None = None) -> Any:
        seeds = [None if seed is None else seed + index for index in range(len(self.envs))]
        given = options or [{} for _ in self.envs]
        starts = [
            env.reset(seed=one, options=other or None) for env, one, other in zip(self.envs, seeds, given, strict=True)
        ]
        self.reset_infos = [info for _, info in starts]
        return self.batch([observation for observation, _ in starts])

    def step(self, actions: Any) -> Any:
        observations, rewards, dones, infos = [], [], [], []
        for index, (env, action) in enumerate(zip(self.envs, actions, strict=True)):
            observation, reward, terminated, truncated, info = env.step(action)
            info["TimeLimit.truncated"] = truncated and not terminated
            if terminated or truncated:
                info["terminal_observation"] = observation
                observation, self.reset_infos[index] = env.reset()
            observations.append(observation)
            rewards.append(reward)
            dones.append(terminated or truncated)
            infos.append(info)
        return self.batch(observations), np.array(rewards, np.float32), np.array(dones), infos
