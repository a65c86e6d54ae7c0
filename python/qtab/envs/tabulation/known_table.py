"""Environments whose transition table ``P`` is known, as Gymnasium's toy text."""

import copy
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import shown
from qtab.envs.metadata.quantities import quantities_of
from qtab.envs.origin.class_code import changed_library_code, is_of_library
from qtab.envs.tabular import TabularEnv
from qtab.envs.tabulation.tabulated_env import TabulatedEnv

_SAMPLED_STEPS = 2_000


def has_known_table(env: Any) -> bool:
    """Returns whether an unwrapped environment has the attributes ``P`` and ``initial_state_distrib``."""
    return hasattr(env, "P") and hasattr(env, "initial_state_distrib")


def tabulate_known(env: Any, max_episode_steps: int | None, max_states: int) -> TabulatedEnv:
    """Returns the table of an environment that has one, with the same probabilities and rewards.

    Args:
        env: The unwrapped environment.
        max_episode_steps: Its time limit in steps; None without one.
        max_states: The most states.

    Raises:
        TypeError: if ``P`` is not a transition table.
        ValueError: if ``P`` is not a valid table or has more states, or the environment does not follow it.
    """
    if len(env.P) > max_states:
        raise ValueError(f"env must have at most max_states={max_states:,} states, got a table P of {len(env.P):,}")
    if getattr(env, "fickle_passenger", False):
        raise ValueError(
            "env must follow its table P, but with fickle_passenger=True the next state also depends on whether the "
            "passenger changes the destination, which the state does not show"
        )
    for name in ("reset", "step"):
        if isinstance(env, TabularEnv) and getattr(type(env), name) is not getattr(TabularEnv, name):
            raise ValueError(f"env must follow its table P, but its class {type(env).__name__} overrides {name}")
    if (other := _other_steps(env)) is not None:
        raise ValueError(
            f"env must follow its table P, but {other}; qtab.TabularEnv(env.P, env.initial_state_distrib) follows it"
        )
    known = quantities_of("" if env.spec is None else env.spec.id)
    table = TabulatedEnv(
        env.P,
        env.initial_state_distrib,
        state_names=getattr(env, "state_names", ()),
        action_names=getattr(env, "action_names", known.actions),
        masks=_masks(env),
        max_episode_steps=max_episode_steps,
    )
    if isinstance(env, TabulatedEnv):
        table.states, table.observations = env.states, env.observations
    if env.observation_space != table.observation_space or env.action_space != table.action_space:
        raise ValueError(
            f"env must have the spaces {table.observation_space} and {table.action_space} of its table P, got "
            f"{env.observation_space} and {env.action_space}"
        )
    if not is_of_library(type(env)):
        _check_steps(env, table)
    return table


def _masks(env: Any) -> NDArray[np.bool_] | None:
    if isinstance(env, TabulatedEnv):
        return env.masks
    method = getattr(env, "action_mask", None)
    if method is None:
        return None
    masks = np.array([method(number) for number in range(len(env.P))]).astype(np.bool_)
    masks[~masks.any(axis=1)] = True  # of terminal states
    return masks


def _other_steps(env: gym.Env) -> str | None:
    """Returns in words why Gymnasium or this package does not reset and step the environment; None if they do."""
    cls = type(env)
    for name in ("reset", "step"):
        owner = next(base for base in cls.__mro__ if name in vars(base))
        if not is_of_library(owner):
            return f"its class {owner.__name__} overrides {name}"
    replaced = next((name for name in vars(env) if callable(getattr(cls, name, None))), None)
    if replaced is not None:
        return f"its method {replaced} was replaced"
    changed = changed_library_code(cls)
    return None if changed is None else f"{changed} was replaced"


def _check_steps(env: gym.Env, table: TabulatedEnv) -> None:
    """Checks on sampled steps that an environment of another class follows its table.

    Raises:
        ValueError: if a step does not follow it.
    """
    env = copy.deepcopy(env)
    actions = np.random.default_rng(0).integers(len(table.P[0]), size=_SAMPLED_STEPS).tolist()
    state = _first(env, table, seed=0)
    for action in actions:
        step: Any = env.step(action)
        next_state, reward, terminated = step[:3]
        listed = table.P[state][action]
        if not any(chance and (next_state, reward, terminated) == tuple(one) for chance, *one in listed):
            raise ValueError(
                f"env must follow its table P, but step({action}) in state {state} returned state "
                f"{shown(next_state)}, reward {shown(reward)} and terminated {terminated}, which P[{state}][{action}] "
                "does not list"
            )
        state = _first(env, table) if terminated or step[3] else int(next_state)


def _first(env: gym.Env, table: TabulatedEnv, **seed: Any) -> int:
    state: Any = env.reset(**seed)[0]
    if not table.observation_space.contains(state) or not table.initial_state_distrib[int(state)]:
        raise ValueError(
            f"env must follow its table P, but reset() returned {shown(state)}, which has no probability in "
            "initial_state_distrib"
        )
    return int(state)
