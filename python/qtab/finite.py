"""What Rust trains on by a table or by a few rules: taken from the environment as it stands."""

from typing import Any

from gymnasium.envs.toy_text.blackjack import BlackjackEnv

from qtab import _core, plan
from qtab.reference.maximization_bias import MaximizationBiasEnv


def describe(env: Any) -> plan.Process | plan.Rules | plan.Bias:
    """Returns what Rust trains on without physics as the extension module takes it; see :func:`process`."""
    if isinstance(env, MaximizationBiasEnv):
        return {"actions": env.actions, "mean": env.mean, "deviation": env.deviation}
    return process(env)


def process(env: Any) -> plan.Process | plan.Rules:
    """Returns an environment of Gymnasium's toy text, or a table of one's own, as the extension module takes it.

    Raises:
        TypeError: for a table that Rust would not add up as NumPy does.
        ValueError: for one that is no table.
    """
    if isinstance(env, BlackjackEnv):
        return {"natural": bool(env.natural), "sab": bool(env.sab)}
    fickle = float(env.fickle_probability) if getattr(env, "fickle_passenger", False) else None
    return {"table": _core.Transitions(env.P, env.initial_state_distrib, exact=True), "fickle": fickle}
