"""The environment that ``evaluate`` and ``verify`` step: the run's, or another that is given and must fit it."""

from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec

from qtab import discretizers
from qtab._utils.shown import shown
from qtab.config.origin import trained_on
from qtab.envs.actions import choose_actions
from qtab.envs.origin.describe import describe
from qtab.envs.origin.differences import differences
from qtab.results.run import Run


def check_spaces(run: Run, env: gym.Env) -> None:
    """Checks that an environment has spaces for which the tables of a run were made.

    Raises:
        ValueError: if it has others.
    """
    try:
        actions = choose_actions(env.action_space, run.config.actions)
        cells = discretizers.build(env.observation_space, run.config, len(actions))
    except ValueError as error:
        raise ValueError(f"env must have the spaces of the run's {run.config.env}, got {_name(env)}: {error}") from None
    theirs = run.discretizer
    if not cells.same_space(theirs) or len(actions) != len(run.actions):
        raise ValueError(
            f"env must have the spaces of the run's {run.config.env}, got {_name(env)} with observations "
            f"{env.observation_space} and actions {env.action_space}"
        )


def check_same(run: Run, env: gym.Env) -> None:
    """Checks that an environment is the one that a run was trained on, as far as that is known.

    Raises:
        ValueError: if it is another one; the message says what differs.
    """
    check_spaces(run, env)
    description = trained_on(run.config)
    if description is not None and (found := differences(description, describe(env))):
        raise ValueError(f"env must be that of the run, got another one: {'; '.join(found)}")


def check_env(env: Any) -> None:
    """Checks the type of the argument ``env``.

    Raises:
        TypeError: if it is neither None, an id, an EnvSpec nor an environment.
    """
    if env is not None and not isinstance(env, str | EnvSpec | gym.Env):
        raise TypeError(f"env must be an environment id, an EnvSpec or an environment, got {shown(env)}")


def _name(env: gym.Env) -> str:
    return env.spec.id if env.spec is not None else type(env.unwrapped).__name__
