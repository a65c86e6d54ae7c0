"""Environments of one's own in a vector environment: those that Numba compiles, and native libraries."""

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import gymnasium as gym
from gymnasium import spaces
from gymnasium.vector import AutoresetMode

from qtab import _core
from qtab.envs.external.capsule import external_env, external_of, has_capsule
from qtab.envs.external.native_env import NativeEnv, space_of
from qtab.envs.functional import FunctionalEnv
from qtab.envs.in_rust.matching import NotInRustError
from qtab.envs.vector.ordinary_class import compiled, reads_options
from qtab.envs.vector.python_vector_env import Snapshot
from qtab.envs.vector.spaces import VectorSpaces

_LOGGER = logging.getLogger("qtab")


class OwnEnv:
    """An environment of one's own, whose copies are stepped together.

    Args:
        make: Makes a sub-environment: a ``FunctionalEnv``, a ``NativeEnv``, another with a capsule, or another class.
        env: One that it has made, perhaps in the wrappers of ``gymnasium.make``. It is never stepped.
        mode: The reset of sub-environments whose episode has ended.
    """

    def __init__(self, make: Callable[[], gym.Env], env: gym.Env, mode: AutoresetMode) -> None:
        self._make, self._env, self._mode = make, env, mode
        self.is_ordinary = not has_capsule(env)
        """Whether it is an ordinary class. Python continues its episodes by playing them again."""
        self.code: str | None = None
        """A digest of the code of an ordinary class that is stepped in Rust."""

    def in_rust(self, num_envs: int, copy: bool) -> _core.NativeEnv | None:
        """Returns the environment as the extension module steps its copies; None if Python must step it.

        The reason is then logged.

        Args:
            num_envs: The number of sub-environments.
            copy: Whether each step returns new arrays of observations.

        Raises:
            ValueError: for an ordinary class that cannot be compiled; the message gives the reason.
        """
        name = self._env.spec.id if self._env.spec is not None else type(self._env.unwrapped).__name__
        try:
            return self._ordinary(num_envs, copy) if self.is_ordinary else _in_rust(self._env, num_envs, copy)
        except NotInRustError as error:
            reason = f"{error}; {error.remedy}" if error.remedy else str(error)
        if self.is_ordinary:
            cls, subject = type(self._env.unwrapped).__name__, "name must be the id of an environment that Rust steps"
            self._env.close()
            reason = f"Rust does not implement {cls}, and it cannot be compiled: {reason}"
            raise ValueError(f"{subject}, got {name!r}: {reason}, or step it with gymnasium.vector.SyncVectorEnv")
        _LOGGER.warning("%s is stepped in Python, which is much slower than Rust: %s", name, reason)
        return None

    def _ordinary(self, num_envs: int, copy: bool) -> _core.NativeEnv:
        one = compiled(self._make, self._env, self._mode is AutoresetMode.SAME_STEP)
        self.code = one.code
        space: Any = self._env.action_space
        mask_dtype = one.rewritten.shown.mask_dtype
        return external_of(one, one.repeat_in_vector).native_env(
            spaces=VectorSpaces(self._env.observation_space, space, num_envs, copy, mask_dtype)
        )

    def needs_python(self, options: Mapping[str, Any] | None) -> bool:
        """Returns whether only Python can begin an episode with these options."""
        if options is None:
            return False
        cls: Any = type(self._env.unwrapped)
        return reads_options(cls) if self.is_ordinary else "state" in options and issubclass(cls, FunctionalEnv)

    def log_options(self) -> None:
        """Logs that Python steps from now on, since only it can begin an episode with options."""
        message = "a vector environment of %s is stepped in Python from now on, as its reset reads options"
        _LOGGER.warning(message, type(self._env.unwrapped).__name__)

    def in_python(self, snapshots: Sequence[Snapshot], not_reset: Sequence[int]) -> list[Snapshot]:
        """Returns snapshots of sub-environments with the attributes that the environment has in Python.

        Args:
            snapshots: Their snapshots, whose attribute ``state`` are the bytes of the state.
            not_reset: The indices of those that were never reset and have no state.
        """
        unwrapped: Any = self._env.unwrapped
        if isinstance(unwrapped, NativeEnv):
            return [({**attributes, "_elapsed": elapsed}, elapsed, *rest) for attributes, elapsed, *rest in snapshots]
        started = [index for index in range(len(snapshots)) if index not in not_reset]
        found = unwrapped._states_in([snapshots[index][0]["state"] for index in started])
        states = dict(zip(started, found, strict=True))
        return [
            ({"state": states[index]} if index in states else {}, *rest) for index, (_, *rest) in enumerate(snapshots)
        ]


def _in_rust(env: gym.Env[Any, Any], num_envs: int, copy: bool) -> _core.NativeEnv:
    unwrapped: Any = env.unwrapped
    if not any(type(unwrapped).__qtab_env__ is cls.__qtab_env__ for cls in (FunctionalEnv, NativeEnv)):
        raise NotInRustError("the infos of its class are known to Python only", "derive it from qtab.FunctionalEnv")
    external: Any = external_env(env, "auto")
    if isinstance(unwrapped, NativeEnv):
        if (unwrapped.observation_space, unwrapped.action_space) != (
            space_of(external),
            spaces.Discrete(external.num_actions),
        ):
            raise NotInRustError("its spaces were changed", "leave them as qtab.NativeEnv makes them")
        if unwrapped.max_episode_steps != external.max_episode_steps:
            raise NotInRustError("its max_episode_steps was changed", "register an id with max_episode_steps")
    vector_spaces = VectorSpaces(env.observation_space, unwrapped.action_space, num_envs, copy)
    made: _core.NativeEnv = external.native_env(spaces=vector_spaces)
    return made
