"""An agent that acts greedily in an environment: a run, or an optimum."""

from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec

from qtab._utils.shown import shown
from qtab.config import Config
from qtab.envs.registry import spec_of
from qtab.planning.optimum import Optimum
from qtab.rendering.replay import check_render_mode, make_render_env
from qtab.results.action_values import greedy_table, summed, weighted_sum
from qtab.results.run import Run
from qtab.results.time_steps import rows_of
from qtab.training.setup.run_env import check_env, check_spaces


@dataclass(frozen=True)
class Agent:
    """An agent and its environment."""

    source: Run | Optimum
    """The object that it was made from."""
    config: Config
    """The environment and the time limit; for a run, all settings."""
    act: Callable[[Any, Any, Any], tuple[Any, Any]]
    """Takes an observation, a state, None at first, and the action mask, None without one; returns the action as
    ``env.step`` takes it, and the state."""


def agent_of(source: Any) -> Agent:
    """Returns the agent of a run or of an optimum.

    Raises:
        TypeError: for anything else.
    """
    if isinstance(source, Run):
        return Agent(source, source.config, _greedy(source))
    if isinstance(source, Optimum):
        return Agent(source, source.config, lambda seen, state, _: source.predict(seen, state))
    hint = "; qtab.load reads one from a file" if isinstance(source, str) or hasattr(source, "__fspath__") else ""
    raise TypeError(f"run must be a Run or an Optimum, got {shown(source)}{hint}")


def _greedy(run: Run) -> Callable[[Any, Any, Any], tuple[Any, Any]]:
    """Returns the policy that :func:`qtab.evaluate` plays, bit for bit."""
    table = greedy_table(run)[0]

    def act(observation: Any, state: Any, mask: Any) -> tuple[Any, Any]:
        steps = 0 if state is None else state
        rows = rows_of(run, observation, steps)
        values = weighted_sum(rows, table) if run.discretizer.is_weighted else summed(table[row] for row in rows)
        if mask is not None:
            values[~mask] = -np.inf
        return run.actions[int(np.argmax(values))], steps + 1

    return act


def rendered_environment(
    agent: Agent,
    env: str | EnvSpec | gym.Env | None,
    env_kwargs: Mapping[str, Any] | None,
    max_episode_steps: int,
    render_mode: str,
) -> gym.Env:
    """Returns the environment in which to render an agent: the agent's, another, or a given one with the time limit.

    Raises:
        gymnasium.error.UnregisteredEnv: without ``env``, for an agent whose environment is not registered.
        TypeError: if ``env`` is neither None, an id, an EnvSpec nor an environment.
        ValueError: for an environment with other spaces than the agent's, that cannot be rendered so, or
            without ``env`` cannot be made again as it was in training.
    """
    check_env(env)
    if isinstance(env, gym.Env):
        _check_spaces(agent, env)
        check_render_mode(type(env.unwrapped).__name__, env, render_mode)
        if env.render_mode != render_mode:
            raise ValueError(f"env must be made with render_mode={render_mode!r}, got {env.render_mode!r}")
        return gym.wrappers.TimeLimit(env, max_episode_steps)
    if env is None:
        return make_render_env(agent.config, render_mode, env_kwargs, max_episode_steps)
    spec = env if isinstance(env, EnvSpec) else spec_of(env)
    kwargs = dict(env_kwargs or {})
    with closing(gym.make(spec, **kwargs)) as plain:
        check_render_mode(spec.id, plain, render_mode)
        _check_spaces(agent, plain)
    return gym.make(spec, max_episode_steps=max_episode_steps, **kwargs | {"render_mode": render_mode})


def _check_spaces(agent: Agent, env: gym.Env) -> None:
    if isinstance(agent.source, Run):
        check_spaces(agent.source, env)
