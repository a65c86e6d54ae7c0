"""Gymnasium's environments as the extension module steps them: by their parameters, their table or their rules."""

from typing import Any

import numpy as np
from gymnasium.envs.toy_text.blackjack import BlackjackEnv

from qtab import _core
from qtab.envs.actions import Actions
from qtab.envs.registry import TABULAR


def native_env(name: str, env: Any, actions: Actions | None = None) -> _core.NativeEnv:
    """Returns an environment that Rust steps, with the current attributes of the unwrapped Gymnasium environment.

    Args:
        name: The name of its registry entry.
        env: The environment.
        actions: The actions that a learner chooses from.

    Raises:
        TypeError: if a table holds types for which Rust would not compute the sums that NumPy does.
        ValueError: if Rust would not compute the same numbers as NumPy, for an attribute, the action space or on this
            machine.
    """
    if not _core.matches_numpy(name):
        raise ValueError("NumPy's sin and cos are not the platform's on this machine, which Rust calls")
    if actions is None or actions.values is None:
        return _core.NativeEnv(name, env)
    if actions.values.dtype != np.float32:
        raise ValueError(f"Rust computes with actions of float32, got {actions.values.dtype}")
    return _core.NativeEnv(name, env, actions.values[:, 0].tolist())


def table_env(env: Any) -> _core.NativeEnv:
    """Returns an environment that Rust steps by the transition table of Gymnasium's toy text, or of any other.

    Raises:
        TypeError: if the table holds types for which Rust would not compute the sums that NumPy does.
        ValueError: if ``P`` and ``initial_state_distrib`` are not a valid table.
    """
    if isinstance(env, BlackjackEnv):
        return native_env("Blackjack", env)
    return native_env("Taxi" if hasattr(env, "fickle_passenger") else TABULAR.name, env)
