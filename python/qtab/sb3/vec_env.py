"""``qtab.sb3.VecEnv``: sub-environments in Rust behind the interface of Stable-Baselines3's ``VecEnv``."""

import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnv as StableBaselines3VecEnv

from qtab._utils import checks
from qtab.envs.vector import RustVectorEnv

_CONSTANT = ("action_space", "metadata", "observation_space", "render_mode", "spec")
"""Attributes that all sub-environments share; reading them does not switch to Python stepping."""


class VecEnv(StableBaselines3VecEnv):  # type: ignore[misc]
    """Stable-Baselines3's ``DummyVecEnv`` with the sub-environments stepped together in Rust.

    It equals ``DummyVecEnv([lambda: gymnasium.make(id)] * num_envs)`` bit for bit: observations, float32 rewards, dones
    and infos, with ``terminal_observation`` and ``TimeLimit.truncated``, seeds and ``reset_infos``. ``VecMonitor`` and
    the other wrappers of Stable-Baselines3 can wrap it.

    ``env_method``, ``set_attr`` and attributes that differ between sub-environments switch to Python stepping. Unlike
    ``DummyVecEnv``, ``set_attr`` sets an attribute on the layer that has it, not on the outermost wrapper.

    Args:
        env: The id of the environment, Gymnasium's or the one with the prefix ``qtab/``.
        num_envs: The number of sub-environments.
        seed: Seeds the sub-environments at the next reset with ``seed``, ``seed + 1``, …; None leaves them unseeded.
        max_episode_steps: A time limit other than the spec's, as in ``gymnasium.make`` (-1: no limit).
        threads: The number of threads; None chooses automatically. It does not change the results.
        kwargs: Further arguments of ``gymnasium.make``, such as ``render_mode``.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an environment that Rust does not implement.
    """

    def __init__(
        self,
        env: str,
        num_envs: int = 1,
        *,
        seed: int | None = None,
        max_episode_steps: int | None = None,
        threads: int | None = None,
        **kwargs: Any,
    ) -> None:
        for name in ("autoreset_mode", "copy"):
            if name in kwargs:
                raise TypeError(f"{name} must be left out: Stable-Baselines3 sets it, got {kwargs[name]!r}")
        self.venv = RustVectorEnv(
            env, num_envs, max_episode_steps, autoreset_mode=AutoresetMode.SAME_STEP, threads=threads, **kwargs
        )
        self._actions: Any = None
        super().__init__(num_envs, self.venv.single_observation_space, self.venv.single_action_space)
        self.metadata = self.venv.example.metadata
        if seed is not None:
            self.seed(checks.integer("seed", seed, least=0))

    def reset(self) -> Any:
        """Starts an episode in every sub-environment, with the seeds and options that were set since the last reset.

        Returns:
            The observations, (num_envs, …), or a tuple of such arrays.
        """
        options = self._options
        if all(other == options[0] for other in options):
            observations, infos = self.venv.reset(seed=self._seeds, options=options[0] or None)
        else:
            observations, infos = self._reset_one_by_one()
        self.reset_infos = info_rows(infos, self.num_envs)
        self._reset_seeds()
        self._reset_options()
        return observations

    def _reset_one_by_one(self) -> tuple[Any, dict[str, Any]]:
        """Resets each sub-environment with its own options; all of them must have been reset before."""
        missing = np.isin(np.arange(self.num_envs), self.venv.not_reset())
        if missing.any():
            self.venv.reset(options={"reset_mask": missing})
        rows: list[dict[str, Any]] = []
        for index, options in enumerate(self._options):
            mask = np.arange(self.num_envs) == index
            observations, infos = self.venv.reset(seed=self._seeds, options={**options, "reset_mask": mask})
            rows.append(infos)
        merged: dict[str, Any] = {}
        for name in rows[0]:
            merged[name] = np.stack([infos[name][index] for index, infos in enumerate(rows)])
        return observations, merged

    def step_async(self, actions: NDArray[Any]) -> None:
        """Keeps the actions for :meth:`step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Steps every sub-environment, and resets those whose episode ends.

        Returns:
            Observations (num_envs, …), rewards (num_envs,) float32, dones (num_envs,) bool, and an info for each.
            If an episode ended, its observation is the first of the next one, and its info is that of the last step.
        """
        observations, rewards, terminated, truncated, infos = self.venv.step(self._actions)
        last_observations = infos.pop("final_obs", None)
        last_infos = infos.pop("final_info", {})
        rows = info_rows(infos, self.num_envs)
        dones = np.logical_or(terminated, truncated)
        if dones.any():
            last_rows = info_rows(last_infos, self.num_envs)
            for index in np.flatnonzero(dones).tolist():
                self.reset_infos[index] = rows[index]
                rows[index] = {**last_rows[index], "terminal_observation": last_observations[index]}
        for row, time_is_up in zip(rows, (truncated & ~terminated).tolist(), strict=True):
            row["TimeLimit.truncated"] = time_is_up
        return observations, rewards.astype(np.float32), dones, rows

    def close(self) -> None:
        """Closes every environment that was created."""
        self.venv.close()

    def get_images(self) -> Sequence[NDArray[Any] | None]:
        """Returns a frame of each sub-environment if ``render_mode`` is "rgb_array"."""
        if self.render_mode != "rgb_array":
            warnings.warn(f"frames need render_mode='rgb_array', got {self.render_mode!r}", stacklevel=2)
            return [None] * self.num_envs
        return self.venv.render()

    def get_attr(self, attr_name: str, indices: int | Iterable[int] | None = None) -> list[Any]:
        """Returns an attribute of each sub-environment, or of those of ``indices``.

        Raises:
            AttributeError: if they do not have it.
        """
        example = self.venv.example
        if self.venv.is_native and not example.has_wrapper_attr(attr_name):
            # Some attributes exist only after a reset; Stable-Baselines3 asks for others to see whether they exist.
            attributes, *_ = self.venv.snapshots()[0]
            if attr_name not in attributes or self.venv.not_reset():
                raise AttributeError(f"{self.venv} has no attribute {attr_name!r}")
        if attr_name in _CONSTANT and self.venv.is_native:
            values: Sequence[Any] = [example.get_wrapper_attr(attr_name)] * self.num_envs
        elif attr_name in ("np_random", "np_random_seed"):
            values = self.venv.get_attr(attr_name)
        else:
            values = [env.get_wrapper_attr(attr_name) for env in self.venv.envs]
        return [values[index] for index in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: int | Iterable[int] | None = None) -> None:
        """Sets an attribute of each sub-environment, or of those of ``indices``, which Python steps from now on."""
        envs = self.venv.envs
        for index in self._get_indices(indices):
            envs[index].set_wrapper_attr(attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: int | Iterable[int] | None = None, **method_kwargs: Any
    ) -> list[Any]:
        """Calls a method of each sub-environment, or of those of ``indices``, which Python steps from now on."""
        if method_name == "render" and not method_args and not method_kwargs:
            frames = self.venv.render()
            return [frames[index] for index in self._get_indices(indices)]
        envs = self.venv.envs
        methods: list[Callable[..., Any]] = [
            envs[index].get_wrapper_attr(method_name) for index in self._get_indices(indices)
        ]
        return [method(*method_args, **method_kwargs) for method in methods]

    def env_is_wrapped(self, wrapper_class: type, indices: int | Iterable[int] | None = None) -> list[bool]:
        """Returns whether each sub-environment, or each of ``indices``, is in a wrapper of this class."""
        layer: Any = self.venv.example
        found = isinstance(layer, wrapper_class)
        while not found and layer is not layer.unwrapped:
            layer = layer.env
            found = isinstance(layer, wrapper_class)
        return [found for _ in self._get_indices(indices)]


def info_rows(infos: dict[str, Any], num_envs: int) -> list[dict[str, Any]]:
    """Returns the info of each sub-environment, from the arrays in which Gymnasium batches them.

    Args:
        infos: An array for each name, and under ``_name`` the mask of the sub-environments that have it.
        num_envs: The number of sub-environments.
    """
    rows: list[dict[str, Any]] = [{} for _ in range(num_envs)]
    for name, values in infos.items():
        mask = infos.get(f"_{name}")
        if mask is None:  # the array is a mask
            continue
        for index in np.flatnonzero(mask).tolist():
            value = values[index]
            # Numbers are Python's, as a single environment returns them.
            rows[index][name] = value.item() if isinstance(value, np.generic) else value
    return rows
