"""An agent that acts greedily in an environment: a run, or an optimum."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec

from qtab._utils.shown import shown
from qtab.envs.registry import spec_of
from qtab.envs.stored import spec_of_run
from qtab.planning.optimum import Optimum
from qtab.rendering.replay import check_render_mode, render_env
from qtab.results.run import Run
from qtab.training.assigned_rows import greedy_table
from qtab.training.given_env import check_env, check_spaces


@dataclass(frozen=True)
class Agent:
    """What acts, and where."""

    source: Run | Optimum
    """What it was made from."""
    env: str
    """The environment's id, or the name of its class."""
    env_kwargs: Mapping[str, Any]
    """Keyword arguments of the environment's constructor."""
    max_episode_steps: int
    """The time limit, in steps."""
    act: Callable[[Any, Any, Any], tuple[Any, Any]]
    """Takes an observation, a state, None at first, and the action mask, None without one; returns the action as
    ``env.step`` takes it, and the state."""


def agent_of(source: Any) -> Agent:
    """Returns the agent of a run or of an optimum.

    Raises:
        TypeError: for anything else.
    """
    if isinstance(source, Run):
        config = source.config
        return Agent(source, config.env, config.env_kwargs, int(config.max_episode_steps or 0), _greedy(source))
    if isinstance(source, Optimum):
        best = source
        return Agent(
            best, best.env, best.env_kwargs, best.max_episode_steps, lambda seen, state, _: best.predict(seen, state)
        )
    hint = "; qtab.load reads one from a file" if isinstance(source, str) or hasattr(source, "__fspath__") else ""
    raise TypeError(f"run must be a Run or an Optimum, got {shown(source)}{hint}")


def _greedy(run: Run) -> Callable[[Any, Any, Any], tuple[Any, Any]]:
    """Returns the policy that :func:`qtab.evaluate` plays, to the bit."""
    table = greedy_table(run)[0]

    def act(observation: Any, state: Any, mask: Any) -> tuple[Any, Any]:
        rows = run.discretizer.active_rows(observation)
        values = table[rows[0]].copy()
        for row in rows[1:]:  # from left to right, as the learners add; np.sum would add in pairs
            values += table[row]
        if mask is not None:
            values[~mask] = -np.inf
        return run.actions[int(np.argmax(values))], state

    return act


def environment_of(
    agent: Agent,
    env: str | EnvSpec | gym.Env | None,
    env_kwargs: Mapping[str, Any] | None,
    max_episode_steps: int,
    render_mode: str,
) -> gym.Env:
    """Returns the environment in which an agent is to be seen: its own, another, or a given one with the time limit.

    Raises:
        gymnasium.error.UnregisteredEnv: without ``env``, for an agent whose environment is not registered.
        TypeError: if ``env`` is neither None, an id, an EnvSpec nor an environment.
        ValueError: for an environment with other spaces than the agent's, or that cannot be rendered so.
    """
    check_env(env)
    if isinstance(env, gym.Env):
        _check_spaces(agent, env)
        check_render_mode(type(env.unwrapped).__name__, env, render_mode)
        if env.render_mode != render_mode:
            raise ValueError(f"env must be made with render_mode={render_mode!r}, got {env.render_mode!r}")
        return gym.wrappers.TimeLimit(env, max_episode_steps)
    if env is None:
        kwargs = agent.env_kwargs if env_kwargs is None else env_kwargs
        return render_env(spec_of_run(agent.env), kwargs, max_episode_steps, render_mode)
    spec = env if isinstance(env, EnvSpec) else spec_of(env)
    made = render_env(spec, env_kwargs or {}, max_episode_steps, render_mode)
    try:
        _check_spaces(agent, made)
    except ValueError:
        made.close()
        raise
    return made


def _check_spaces(agent: Agent, env: gym.Env) -> None:
    if isinstance(agent.source, Run):
        check_spaces(agent.source, env)
