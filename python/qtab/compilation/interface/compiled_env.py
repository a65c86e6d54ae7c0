"""A compiled environment: its code, and the layouts of its memory."""

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.compilation.cache.machine_code import LoadedCode, function_at
from qtab.compilation.interface.pycapsule import make_capsule
from qtab.compilation.interface.qtab_env import VERSION, Observe, QtabEnv, Reset, Step
from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.layouts.value_layout import Layout, dtype_of

FUNCTIONS = ("qtab_reset", "qtab_step", "qtab_observe")
"""The names of the C functions in the code."""


@dataclass(frozen=True, eq=False)
class CompiledEnv:
    """The code of an environment, without the values of its parameters."""

    code: LoadedCode
    state: Layout
    observation: ObservationLayout
    num_actions: int
    has_action_mask: bool

    @property
    def state_size(self) -> int:
        """The number of bytes of a state."""
        return max(1, dtype_of(self.state).itemsize)

    def struct(self, parameters: NDArray[np.uint8]) -> tuple[QtabEnv, tuple[Any, ...]]:
        """Returns the struct of the environment, and the objects with the memory that it points to.

        Args:
            parameters: The parameters, which the struct points to.
        """
        low, high = self.observation.low, self.observation.high
        reset, step, observe = (self.code.addresses[name] for name in FUNCTIONS)
        struct = QtabEnv(
            version=VERSION,
            struct_size=ctypes.sizeof(QtabEnv),
            state_size=self.state_size,
            observation_type=self.observation.type,
            observation_size=self.observation.size,
            observation_low=low.ctypes.data,
            observation_high=high.ctypes.data,
            num_actions=self.num_actions,
            max_episode_steps=0,
            has_action_mask=int(self.has_action_mask),
            reserved=0,
            parameters=parameters.ctypes.data,
            reset=reset,
            step=step,
            observe=observe,
        )
        return struct, (self.code, low, high, parameters)

    def capsule(self, parameters: NDArray[np.uint8]) -> Any:
        """Returns the capsule of the environment with these parameters."""
        struct, needed = self.struct(parameters)
        return make_capsule(struct, *needed)


class Stepper:
    """Calls the functions of a compiled environment from Python, for comparisons.

    Args:
        env: The compiled environment.
        parameters: Its parameters.
        bit_generator: The generator, whose state the functions change.
    """

    def __init__(self, env: CompiledEnv, parameters: NDArray[np.uint8], bit_generator: Any) -> None:
        addresses = [env.code.addresses[name] for name in FUNCTIONS]
        self._functions = [function_at(of, at) for of, at in zip((Reset, Step, Observe), addresses, strict=True)]
        self.bit_generator, self._parameters = bit_generator, parameters
        self._rng = ctypes.cast(bit_generator.ctypes.bit_generator, ctypes.c_void_p).value
        self.state, self._next = _aligned(env.state_size), _aligned(env.state_size)
        self.observation = np.zeros(env.observation.size, env.observation.dtype)
        self.action_mask = np.zeros(env.num_actions, np.uint8)
        self.reward = np.zeros(1)

    def reset(self) -> int:
        """Writes the first state; returns what the function returns."""
        written = (self.state, self.observation, self.action_mask)
        code: int = self._functions[0](self._parameters.ctypes.data, self._rng, *(one.ctypes.data for one in written))
        return code

    def step(self, action: int) -> int:
        """Takes an action, counted from 0; the state stays as it was if the function fails."""
        self._next[:] = 0
        written = (self._next, self.observation, self.reward, self.action_mask)
        code: int = self._functions[1](
            self._parameters.ctypes.data,
            self._rng,
            self.state.ctypes.data,
            action,
            *(one.ctypes.data for one in written),
        )
        if code >= 0:
            self.state, self._next = self._next, self.state
        return code

    def observe(self) -> int:
        """Writes the observation and the mask of the state."""
        written = (self.observation, self.action_mask)
        code: int = self._functions[2](
            self._parameters.ctypes.data, self.state.ctypes.data, *(one.ctypes.data for one in written)
        )
        return code


def _aligned(size: int) -> NDArray[np.uint8]:
    """Returns bytes at an address that is a multiple of 16."""
    memory = np.zeros(size + 16, np.uint8)
    first = -memory.ctypes.data % 16
    return memory[first : first + size]
