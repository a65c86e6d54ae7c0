"""Ordinary classes that Python steps through the interface of compiled ones, to resume a run that was compiled."""

import ctypes
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.compilation.interface.pycapsule import make_capsule
from qtab.compilation.interface.qtab_env import FAILED, VERSION, Observe, QtabEnv, Reset, Step
from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.twins.repetition import Repetition, Result
from qtab.envs.external.positions import Position


def _fail(*_arguments: Any) -> int:
    return FAILED


_FUNCTIONS = Reset(_fail), Step(_fail), Observe(_fail)


class SteppedInPython:
    """An ordinary class whose C functions always fail, so that each episode is repeated, and played, in Python.

    A run that was compiled on another machine is resumed with it where Numba is missing: its numbers are the same.

    Args:
        env: The environment, without wrappers. It is not changed.
        name: Its name in messages.
        has_action_mask: Whether it has action masks.

    Raises:
        NotCompilable: if it has spaces that compiled code cannot have either.
    """

    def __init__(self, env: gym.Env, name: str, has_action_mask: bool) -> None:
        self._env, self._name, self._has_action_mask = env, name, has_action_mask
        self._observation = ObservationLayout.of(env.observation_space)
        self._record = np.dtype([("unused", np.uint8)])

    def capsule(self) -> Any:
        """Returns the capsule ``qtab.env.1``."""
        observation, space = self._observation, self._env.action_space
        unused = np.zeros(1, np.uint8)
        reset, step, observe = (ctypes.cast(one, ctypes.c_void_p).value for one in _FUNCTIONS)
        struct = QtabEnv(
            version=VERSION,
            struct_size=ctypes.sizeof(QtabEnv),
            state_size=1,
            observation_type=observation.type,
            observation_size=observation.size,
            observation_low=observation.low.ctypes.data,
            observation_high=observation.high.ctypes.data,
            num_actions=int(space.n),  # type: ignore[attr-defined]
            max_episode_steps=0,
            has_action_mask=int(self._has_action_mask),
            reserved=0,
            parameters=unused.ctypes.data,
            reset=reset,
            step=step,
            observe=observe,
        )
        return make_capsule(struct, observation.low, observation.high, unused)

    def repeat(
        self, _state: bytes | None, before: Position, action: int | None, seed: int, played: Any
    ) -> tuple[Result, Callable[[int], Result]]:
        """Repeats an episode in Python up to a call; see :meth:`qtab.compilation.ordinary.OrdinaryEnv.repeat`."""
        repetition = Repetition(self._env, self._record, self._observation, seed, self._name)
        if action is None:
            return repetition.reset(before), repetition.step
        start, actions = played
        repetition.play(start, actions, before)
        return repetition.step(action), repetition.step
