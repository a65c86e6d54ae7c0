"""The transition table of an environment, in the form that planning uses."""

from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec
from gymnasium.envs.toy_text.blackjack import BlackjackEnv

from qtab import _core
from qtab._utils.shown import shown
from qtab.discretizers.identity import Identity
from qtab.envs.actions import Actions, choose_actions
from qtab.envs.in_rust.matching import unknown_wrapper
from qtab.envs.in_rust.native import table_env
from qtab.envs.registry import make_env, named_spec


@dataclass(frozen=True, eq=False)
class Table:
    """An environment with a transition table."""

    name: str
    """The environment's id, or the name of its class."""
    env: gym.Env
    cells: Identity
    """The discretizer from observations to rows."""
    actions: Actions
    native: _core.NativeEnv
    """The environment in Rust."""
    solver: _core.MdpSolver
    """The Markov decision process. Its first states are those that observations show; if an observation hides part of
    the state, the hidden variants follow."""


@contextmanager
def opened_env(
    env: Any, env_kwargs: Mapping[str, Any] | None, known: str = "an environment id, an EnvSpec or an environment"
) -> Iterator[tuple[str, gym.Env]]:
    """Yields the name of an environment and the environment, which is closed afterwards if it was made here.

    Args:
        env: An id, a spec or an environment.
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.
        known: The accepted forms of ``env``, for messages.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        TypeError: for an argument of the wrong type.
        ValueError: for keyword arguments with an environment.
    """
    if isinstance(env, gym.Env):
        if env_kwargs is not None:
            raise ValueError(f"env_kwargs must be None if env is an environment object, got {shown(env_kwargs)}")
        yield _name(env), env
        return
    if not isinstance(env, str | EnvSpec):
        raise TypeError(f"env must be {known}, got {shown(env)}")
    if env_kwargs is not None and not isinstance(env_kwargs, Mapping):
        raise TypeError(f"env_kwargs must map names to values, got {shown(env_kwargs)}")
    name, spec = named_spec(env) if isinstance(env, str) else (env.id, env)
    with closing(make_env(spec, env_kwargs or {})) as made:
        yield name, made


@contextmanager
def opened_table(env: str | EnvSpec | gym.Env, env_kwargs: Mapping[str, Any] | None) -> Iterator[Table]:
    """Yields the table of an environment. An environment made here, from an id or a spec, is closed afterwards.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        TypeError: for an argument of the wrong type.
        ValueError: for an environment without a table, with a wrapper that may change numbers, or with a table whose
            states or actions do not fit its spaces.
    """
    with opened_env(env, env_kwargs) as (_, opened):
        yield table_of(opened)


def has_transition_table(env: Any) -> bool:
    """Returns whether the transitions of an unwrapped environment are known."""
    return isinstance(env, BlackjackEnv) or (hasattr(env, "P") and hasattr(env, "initial_state_distrib"))


def check_wrappers(env: gym.Env) -> None:
    """Checks that results for the unwrapped environment also hold for the environment.

    Raises:
        ValueError: if the environment has a wrapper that may change numbers.
    """
    wrapper = unknown_wrapper(env)
    if wrapper is not None:
        raise ValueError(f"env must have no wrapper that may change observations or rewards, got {wrapper}")


def table_of(env: gym.Env) -> Table:
    """Returns the table of an environment; see :func:`opened_table`."""
    name = _name(env)
    check_wrappers(env)
    if not has_transition_table(env.unwrapped):
        raise ValueError(
            f"env must have a transition table P and an initial_state_distrib, or be Blackjack: the values of {name} "
            "cannot be computed; qtab.tabulate(env) makes the table of an environment with few states"
        )
    actions = choose_actions(env.action_space, None)
    cells = Identity.of_space(env.observation_space, len(actions))
    native = table_env(env.unwrapped)
    solver = _core.MdpSolver(native)
    if len(solver.rows) < cells.n_rows or solver.n_actions != len(actions):
        raise ValueError(f"P must have {cells.n_rows} states of {len(actions)} actions, as the spaces of env have")
    return Table(name, env, cells, actions, native, solver)


def _name(env: gym.Env) -> str:
    return env.spec.id if env.spec is not None else type(env.unwrapped).__name__
