"""Environment objects described for the extension module: constants, transition tables, rules."""

from typing import Any

import numpy as np
from gymnasium.envs.toy_text.blackjack import BlackjackEnv

from qtab import _core
from qtab import _spec as plan
from qtab.discretizers.actions import Actions
from qtab.envs.maximization_bias import MaximizationBiasEnv


def native_spec(env: Any) -> plan.Process | plan.Rules | plan.Bias:
    """Returns the description of an environment whose registry entry has a table; see :func:`toy_text_spec`."""
    if isinstance(env, MaximizationBiasEnv):
        return {"actions": env.actions, "mean": env.mean, "deviation": env.deviation}
    return toy_text_spec(env)


def toy_text_spec(env: Any) -> plan.Process | plan.Rules:
    """Returns the description of a toy text environment or of any other environment with a transition table.

    Raises:
        TypeError: if the table holds types for which Rust would not compute the sums that NumPy does.
        ValueError: if ``P`` and ``initial_state_distrib`` are not a valid table.
    """
    if isinstance(env, BlackjackEnv):
        return {"natural": bool(env.natural), "sab": bool(env.sab)}
    fickle = float(env.fickle_probability) if getattr(env, "fickle_passenger", False) else None
    return {"table": _core.Transitions(env.P, env.initial_state_distrib, exact=True), "fickle": fickle}


def classic_spec(env: Any, model: str, actions: Actions) -> plan.Control:
    """Returns the description of a classic control environment.

    Raises:
        ValueError: if Rust would not compute the same numbers as NumPy for an attribute, the action space or on this
            machine.
    """
    if not _core.computes_as_numpy(model):
        raise ValueError("NumPy's sin and cos are not the platform's on this machine, which Rust calls")
    if actions.values is not None and actions.values.dtype != np.float32:
        raise ValueError(f"Rust computes with actions of float32, got {actions.values.dtype}")
    forces = [] if actions.values is None else actions.values[:, 0].tolist()
    return {"constants": _core.Classic(model, env), "forces": forces}
