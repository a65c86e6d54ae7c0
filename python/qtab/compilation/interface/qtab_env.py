"""The struct of ``qtab_env.h`` in ctypes."""

import ctypes
from typing import Any

VERSION = 1
"""``QTAB_ENV_VERSION``."""

FLOAT32, FLOAT64, INT64 = 0, 1, 2
"""The types of the numbers of an observation."""

CONTINUES, TERMINATED, TRUNCATED, FAILED = 0, 1, 2, -1
"""What ``reset`` and ``step`` return: a sum of the first three, or ``FAILED``."""

_POINTER = ctypes.c_void_p
Reset: Any = ctypes.CFUNCTYPE(ctypes.c_int32, *[_POINTER] * 5)
"""``reset(parameters, rng, state, observation, action_mask)``."""
Step: Any = ctypes.CFUNCTYPE(ctypes.c_int32, *[_POINTER] * 3, ctypes.c_int64, *[_POINTER] * 4)
"""``step(parameters, rng, state, action, next_state, observation, reward, action_mask)``."""
Observe: Any = ctypes.CFUNCTYPE(ctypes.c_int32, *[_POINTER] * 4)
"""``observe(parameters, state, observation, action_mask)``."""


class QtabEnv(ctypes.Structure):
    """``qtab_env``; the header explains the fields."""

    _fields_ = (
        ("version", ctypes.c_uint32),
        ("struct_size", ctypes.c_uint32),
        ("state_size", ctypes.c_uint64),
        ("observation_type", ctypes.c_uint32),
        ("observation_size", ctypes.c_uint32),
        ("observation_low", _POINTER),
        ("observation_high", _POINTER),
        ("num_actions", ctypes.c_int64),
        ("max_episode_steps", ctypes.c_int64),
        ("has_action_mask", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("parameters", _POINTER),
        ("reset", _POINTER),
        ("step", _POINTER),
        ("observe", _POINTER),
    )
