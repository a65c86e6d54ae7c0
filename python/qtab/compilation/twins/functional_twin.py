"""A functional environment that is stepped in Python, to compare it with compiled code."""

import copy
import math
from typing import Any

import numpy as np

from qtab.compilation.interface.compiled_env import CompiledEnv
from qtab.compilation.layouts.value_layout import encode


class FunctionalTwin:
    """Steps a functional environment in Python, without changing the object.

    Args:
        env: The environment.
        compiled: The compiled environment, whose layouts the numbers are given in.
        values: The attributes that the functions read.
    """

    def __init__(self, env: Any, compiled: CompiledEnv, values: dict[str, Any]) -> None:
        self._env, self._compiled = object.__new__(type(env)), compiled
        vars(self._env).update({**vars(env), **copy.deepcopy(values)})
        self._first = int(env.action_space.start)
        self._state: Any = None

    def reset(self, rng: np.random.Generator) -> dict[str, Any]:
        """Draws the first state, and returns the numbers by their names."""
        self._state = self._env.initial_state(rng)
        return self._numbers(False)

    def step(self, action: int, rng: np.random.Generator) -> dict[str, Any]:
        """Takes an action, counted from 0, and returns the numbers by their names."""
        state, reward, terminated = self._env.transition(self._state, self._first + action, rng)
        number = float(reward)
        if not math.isfinite(number):  # compiled code fails, so that the step is repeated
            raise ValueError(f"the reward is {number}")
        self._state = state
        return {"reward": number, "terminated": bool(terminated), **self._numbers(bool(terminated))}

    def _numbers(self, terminated: bool) -> dict[str, Any]:
        numbers = {
            "state": encode(self._compiled.state, self._state),
            "observation": self._compiled.observation.numbers(self._env._observation(self._state)),
        }
        if self._compiled.has_action_mask:
            numbers["action_mask"] = self._env._info(self._state, terminated)["action_mask"].astype(np.uint8)
        return numbers
