"""The environment of a run: makes it again as in training, resolves settings in it, compares others with it."""

from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import replace
from functools import partial
from typing import Any, Literal

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec

from qtab import discretizers
from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.config.merge import Base, over
from qtab.config.options import is_set
from qtab.config.origin import copied, trained_on
from qtab.envs.actions import choose_actions
from qtab.envs.in_rust.matching import time_limit
from qtab.envs.origin.again import cannot_be_made, make_again, needs_object
from qtab.envs.origin.describe import describe
from qtab.envs.origin.description import EnvironmentDescription, differences
from qtab.envs.registry import ENTRIES, gymnasium_id, hint_for, make_env, spec_of, spec_of_run
from qtab.results.run import Run
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import ResolvedRun

Attempt = Callable[[Any, dict[str, Any]], ResolvedRun]
"""Resolves settings in an environment, given as an id or as a function that makes it."""


def make_run_env(
    config: Config,
    *,
    of: Literal["either", "gymnasium", "id"] = "either",
    env_kwargs: Mapping[str, Any] | None = None,
    max_episode_steps: int | None = None,
    render_mode: str | None = None,
) -> gym.Env:
    """Makes the environment of a run, with its wrappers, its arguments, its changed attributes and its time limit.

    An id from a file must already be registered: no module is imported for it.

    Args:
        config: The config of the run.
        of: The class to make for an environment that both Gymnasium and this package implement, with equal numbers:
            "either" makes the faster one (this package's), "gymnasium" Gymnasium's, and "id" that of the run's id.
        env_kwargs: Keyword arguments of the environment; None takes the run's.
        max_episode_steps: The time limit, in steps; None takes the run's.
        render_mode: The render mode; None does not render.

    Raises:
        gymnasium.error.UnregisteredEnv: if the run was trained on an environment that is not registered.
        ValueError: if the environment cannot be made as it was; the message gives the reason and asks for ``env=``.
    """
    name = gymnasium_id(config.env)
    known = name in ENTRIES and of != "id"
    spec = spec_of(name if of == "gymnasium" else f"qtab/{name}") if known else spec_of_run(config.env)
    rendering = {} if render_mode is None else {"render_mode": render_mode}
    kwargs = {**(config.env_kwargs if env_kwargs is None else env_kwargs), **rendering}
    limit = config.max_episode_steps if max_episode_steps is None else max_episode_steps
    description = trained_on(config)
    if description is None or _others(config, env_kwargs):
        if description is not None:
            _check_plain(config, description)
        return make_env(spec, kwargs, max_episode_steps=limit, disable_env_checker=True)
    return make_again(description, spec, kwargs, limit)


def can_be_made(config: Config) -> bool:
    """Returns whether the environment of a run can be made as it was in training."""
    try:
        make_run_env(config).close()
    except (gym.error.UnregisteredEnv, ModuleNotFoundError, ValueError):
        return False
    return True


def resolve_run(config: Config, settings: Mapping[str, Any]) -> ResolvedRun:
    """Resolves settings in the environment of a run.

    Raises:
        gymnasium.error.UnregisteredEnv: if the run was trained on an environment that is not registered.
        ValueError: if the environment cannot be made as it was, or a setting does not fit.
    """
    spec_of_run(config.env)  # raises for a class name, which is not an id
    return as_in_training(config, {"env_kwargs": config.env_kwargs, **settings}, resolve)[0]


def as_in_training(
    config: Config, settings: Mapping[str, Any], attempt: Attempt
) -> tuple[ResolvedRun, Any, dict[str, Any]]:
    """Resolves settings in the environment of a config's run: by its id if the id makes the training environment.

    Args:
        config: The config.
        settings: The settings given.
        attempt: Resolves settings in an environment.

    Returns:
        The resolved run, and the environment and the settings that ``attempt`` was called with.

    Raises:
        ValueError: if the environment cannot be made as it was, or a setting does not fit.
    """
    description, asked = trained_on(config), dict(settings)
    if description is None:
        return attempt(config.env, asked), config.env, asked
    if _others(config, asked.get("env_kwargs")):
        _check_plain(config, description)
        return attempt(config.env, asked), config.env, asked
    if not needs_object(description, spec_of_run(config.env)):
        resolved = attempt(config.env, asked)
        if not differences(description, environment_of(resolved)):
            return resolved, config.env, asked
        resolved.close()
    limit = asked.get("max_episode_steps")
    if is_set(limit):
        limit = checks.count("max_episode_steps", limit, least=1)
    make = partial(make_run_env, config, of="id", max_episode_steps=limit)
    asked["env_kwargs"] = {}
    return attempt(make, asked), make, asked


def environment_of(resolved: ResolvedRun) -> EnvironmentDescription:
    """Returns the description of the environment of a resolved run."""
    description = trained_on(resolved.config)
    if description is None:
        raise AssertionError("a resolved run knows its environment")
    return description


def _others(config: Config, env_kwargs: Any) -> bool:
    """Returns whether ``env_kwargs`` are given and differ from those of a config."""
    if env_kwargs is None:
        return False
    return not isinstance(env_kwargs, Mapping) or dict(env_kwargs) != dict(config.env_kwargs)


def _check_plain(config: Config, description: EnvironmentDescription) -> None:
    """Checks that the environment is the one its id makes: otherwise new arguments would undo changes made to it."""
    with closing(make_env(spec_of_run(config.env), config.env_kwargs, disable_env_checker=True)) as env:
        changed = differences(description, describe(env, is_new=True))
    if changed:
        raise cannot_be_made(description, f"other env_kwargs are given, and {'; '.join(changed)}")


def base_for(env: Any, config: Any, base: Config) -> Config:
    """Returns the base config of a call: the config as given if its environment is the object of the call.

    Args:
        env: The environment of the call.
        config: The config of the call.
        base: The base that :func:`qtab.config.merge.collect` returned, without the settings derived from another
            environment.
    """
    if isinstance(env, gym.Env) and isinstance(config, Config):
        description = trained_on(config)
        if description is not None and not differences(description, describe(env)):
            return replace_checked(config, env_kwargs={})
    return base


def resolve_over(
    env: Any, base: Base, settings: Mapping[str, Any], attempt: Attempt
) -> tuple[ResolvedRun, Any, dict[str, Any]]:
    """Resolves the settings of a call over its base config.

    Args:
        env: The environment of the call.
        base: The config or the settings that the call starts from.
        settings: The settings given.
        attempt: Resolves settings in an environment.

    Returns:
        The resolved run, and the environment and the settings that ``attempt`` was called with.

    Raises:
        ValueError: if the environment of the config cannot be made as it was, or a setting does not fit.
    """
    asked = over(base, settings)
    if not isinstance(base, Config):
        return attempt(env, asked), env, asked
    if env != base.env:
        return _with_origin_of(attempt(env, asked), base, settings), env, asked
    resolved, made, asked = as_in_training(base, asked, attempt)
    return _with_origin_of(resolved, base, settings), made, asked


def _with_origin_of(resolved: ResolvedRun, config: Config, names: Mapping[str, Any]) -> ResolvedRun:
    """Returns a resolved run that records which of the settings taken from a config had been derived there.

    Args:
        resolved: The resolved run.
        config: The config.
        names: The settings given, which override the config.
    """
    ours, theirs = resolved.config.origin, config.origin
    if ours is None or theirs is None or theirs.environment is None:
        return resolved
    origin = replace(ours, derived=ours.derived | theirs.without(names).derived)
    return replace(resolved, config=copied(resolved.config, origin))


def check_spaces(run: Run, env: gym.Env) -> None:
    """Checks that an environment has the spaces that the tables of a run were made for.

    Raises:
        ValueError: if the spaces differ.
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
        ValueError: if it is not; the message lists the differences.
    """
    check_spaces(run, env)
    check_described(run.config, env, "run")


def check_described(config: Config, env: gym.Env, owner: str) -> None:
    """Checks that an environment is that of a config, as far as that is known.

    Args:
        config: The config.
        env: The environment.
        owner: The word for what has the config, for messages.

    Raises:
        ValueError: if it is not; the message lists the differences.
    """
    description = trained_on(config)
    if description is not None and (found := differences(description, describe(env))):
        raise ValueError(f"env must be that of the {owner}, got another one: {'; '.join(found)}")


def limited(config: Config, env: gym.Env, owner: str) -> gym.Env:
    """Returns an environment with the time limit of a config.

    Args:
        config: The config.
        env: The environment.
        owner: The word for what has the config, for messages.

    Raises:
        ValueError: if the environment ends episodes earlier.
    """
    limit, own = checks.required("max_episode_steps", config.max_episode_steps), time_limit(env)
    if own is not None and own < limit:
        raise ValueError(f"env must have the time limit of the {owner}, {limit:,} steps, or none, got {own:,}")
    return gym.wrappers.TimeLimit(env, limit)


def check_env(env: Any) -> None:
    """Checks the type of the argument ``env``.

    Raises:
        TypeError: if ``env`` is not None, an id, an EnvSpec or an environment.
    """
    if env is not None and not isinstance(env, str | EnvSpec | gym.Env):
        expected = "an environment id, an EnvSpec or an environment"
        raise TypeError(f"env must be {expected}, got {shown(env)}{hint_for(env)}")


def _name(env: gym.Env) -> str:
    return env.spec.id if env.spec is not None else type(env.unwrapped).__name__
