"""Gymnasium's environments as the extension module takes them: constants, transition tables, rules."""

from typing import Any

import numpy as np
from gymnasium.envs.toy_text.blackjack import BlackjackEnv

from qtab import _core
from qtab import _spec as plan
from qtab.discretizers.actions import Actions
from qtab.envs.maximization_bias import MaximizationBiasEnv


def native_spec(env: Any) -> plan.Process | plan.Rules | plan.Bias:
    """Returns what Rust trains on without physics as the extension module takes it; see :func:`toy_text_spec`."""
    if isinstance(env, MaximizationBiasEnv):
        return {"actions": env.actions, "mean": env.mean, "deviation": env.deviation}
    return toy_text_spec(env)


def toy_text_spec(env: Any) -> plan.Process | plan.Rules:
    """Returns an environment of Gymnasium's toy text, or a table of one's own, as the extension module takes it.

    Raises:
        TypeError: for a table that Rust would not add up as NumPy does.
        ValueError: for one that is no table.
    """
    if isinstance(env, BlackjackEnv):
        return {"natural": bool(env.natural), "sab": bool(env.sab)}
    fickle = float(env.fickle_probability) if getattr(env, "fickle_passenger", False) else None
    return {"table": _core.Transitions(env.P, env.initial_state_distrib, exact=True), "fickle": fickle}


def classic_spec(env: Any, model: str, actions: Actions) -> plan.Control:
    """Returns an environment of Gymnasium's classic control as the extension module takes it.

    Raises:
        ValueError: for an attribute, an action space or a machine for which Rust does not compute what NumPy does.
    """
    if not _core.computes_as_numpy(model):
        raise ValueError("NumPy's sin and cos are not the platform's on this machine, which Rust calls")
    if actions.values is not None and actions.values.dtype != np.float32:
        raise ValueError(f"Rust computes with actions of float32, got {actions.values.dtype}")
    forces = [] if actions.values is None else actions.values[:, 0].tolist()
    return {"constants": _core.Classic(model, env), "forces": forces}
