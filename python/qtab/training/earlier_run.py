"""The run that a call resumes: loads it, and checks that it can be resumed with the settings given."""

import logging
import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.config.functions import STORED, MissingFunction
from qtab.config.merge import Base, over
from qtab.config.options import is_set
from qtab.config.origin import copied, trained_on
from qtab.discretizers.assigned_rows import AssignedRows
from qtab.envs.origin.description import differences
from qtab.envs.registry import versioned
from qtab.results.files.loading import load, with_action_mask
from qtab.results.rates import extensions
from qtab.results.recording import resumed_snapshot_episodes
from qtab.results.run import Run
from qtab.training.callbacks import TrainingOptions
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import ResolvedRun
from qtab.training.setup.run_env import environment_of, resolve_run

_LOGGER = logging.getLogger("qtab")
_OF_ENV = ("env_kwargs", "max_episode_steps")
"""The settings that an environment object determines; another value changes the dynamics."""


def earlier_run(name: str, run: Any, action_mask: Any = None) -> Run:
    """Returns a run, given as an object or as the path of its file.

    Args:
        name: The name of the argument, for messages.
        run: The value of the argument.
        action_mask: The function for the action masks, which a file cannot hold; any other value is ignored.

    Raises:
        OSError: if the file cannot be read.
        TypeError: if ``run`` is neither a run nor a path.
        ValueError: for a file that is not a run.
    """
    if not isinstance(run, Run):
        if not isinstance(run, str | os.PathLike):
            raise TypeError(f"{name} must be a Run or the path of a saved run, got {shown(run)}")
        run = load(Path(run))
    found: Run = run
    if callable(action_mask) and found.config.action_mask == STORED:
        return with_action_mask(found, action_mask)
    return found


def resolve_resumed(
    run: Any, env: Any, base: Base, settings: Mapping[str, Any], options: TrainingOptions
) -> tuple[Run, TrainingOptions, ResolvedRun | None]:
    """Resolves a call of :func:`qtab.train` with ``resume``.

    Args:
        run: The argument ``resume``.
        env: The environment of the call; None takes that of the run.
        base: The config or the settings that the call starts from.
        settings: The settings given.
        options: The other arguments of the call.

    Returns:
        The run, the options of its continuation, and the resolved whole run: None if the run has all its episodes.

    Raises:
        Exception: the errors of :func:`qtab.train` for this argument.
    """
    asked = over(base, settings)
    earlier = _with_function(earlier_run("resume", run, asked.get("action_mask")), asked.get("discretizer"))
    options = replace(options, visits=counts_visits(earlier, options.visits))
    check_agrees(earlier, env, asked)
    if has_finished(earlier, asked.get("episodes"), options):
        return earlier, options, None
    made = env if isinstance(env, gym.Env) else None
    return earlier, options, resolve_again("resume", earlier, asked.get("episodes"), made)


def resolve_again(name: str, run: Run, episodes: Any, env: gym.Env | None) -> ResolvedRun:
    """Resolves the whole run, given its earlier part.

    Args:
        name: The name of the argument that gives the earlier part, for messages.
        run: The earlier part.
        episodes: The number of episodes of the whole run; None takes that of ``run``.
        env: The environment; None makes the environment of ``run``.

    Raises:
        gymnasium.error.Error: if the environment is not registered.
        TypeError: for an argument of the wrong type.
        ValueError: if the run cannot be resumed, has already finished that many episodes, or ``env`` is not the
            environment of ``run``.
    """
    config = _config(name, run, episodes)
    _check_id(run, env)
    # Derived settings are kept, not derived again.
    kept = {"max_episode_steps": config.max_episode_steps, "backend": config.backend}
    if env is None:
        resolved = resolve_run(config, over(config, kept))
    else:
        # The environment object determines its keyword arguments.
        resolved = resolve(env, over(config, {**kept, "env_kwargs": {}}))
        _check_settings(run, resolved.config, _OF_ENV)
        _check_env(run, resolved)
    origin = config.origin or resolved.config.origin
    same = replace_checked(resolved.config, env_kwargs=config.env_kwargs)
    resolved = replace(resolved, config=copied(same, origin))
    if isinstance(run.discretizer, AssignedRows):  # rows are assigned where the earlier part stopped
        resolved = replace(resolved, discretizer=run.discretizer.as_learned())
    return replace(resolved, extensions=extensions(run, config))


def has_finished(run: Run, episodes: Any, options: TrainingOptions) -> bool:
    """Returns whether a run has all its episodes already and no more are requested, and logs this.

    Args:
        run: The earlier part.
        episodes: The number of episodes that the whole run is to have; None takes that of ``run``.
        options: The other arguments of the call, which are checked.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    total = run.config.episodes
    if episodes is not None and checks.count("episodes", episodes, least=1) != total:
        return False
    if len(run.episode_returns) < total:
        return False
    snapshots_of(options, total, run)
    _LOGGER.warning("the run has finished its %s episodes: there is nothing to train", f"{total:,}")
    return True


def _with_function(run: Run, function: Any) -> Run:
    """Returns a run from a file, with its discretizer replaced by the original function if one is given."""
    if not isinstance(run.config.discretizer, MissingFunction) or not callable(function):
        return run
    config = replace_checked(run.config, discretizer=function)
    return replace(run, config=config, discretizer=run.discretizer.with_function(function))


def check_agrees(run: Run, env: str | EnvSpec | gym.Env | None, settings: Mapping[str, Any]) -> None:
    """Checks that the settings given with ``resume`` are those of the run. The number of episodes may differ.

    Args:
        run: The run that is resumed.
        env: The environment given, or None.
        settings: The settings given; those that are None count as not given.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a setting with another value; the message names the first of them.
    """
    given = {name: value for name, value in settings.items() if is_set(value) and name != "episodes"}
    if env is None and not given:
        return
    _check_id(run, env)
    kept = {"backend": run.config.backend, **given}
    if env is None or isinstance(env, str):
        resolved = resolve_run(run.config, over(run.config, kept))
    else:
        resolved = resolve(env, over(run.config, {"env_kwargs": {}, **kept}))
    resolved.close()
    _check_settings(run, resolved.config, (*_OF_ENV, *given))
    _check_env(run, resolved)


def _check_id(run: Run, env: Any) -> None:
    """Checks that the environment given, if any, has the id or class of the run's environment."""
    if env is not None and (id_given := _id(env)) is not None and _bare(id_given) != _bare(run.config.env):
        raise _differs("env", run.config.env, id_given)


def _check_env(run: Run, resolved: ResolvedRun) -> None:
    """Checks that the resolved environment is the one the run was trained on, as far as that is known."""
    description = trained_on(run.config)
    if description is not None and (found := differences(description, environment_of(resolved))):
        raise ValueError(f"env must be that of the run to resume, got another one: {'; '.join(found)}")


def _check_settings(run: Run, config: Config, names: Iterable[str]) -> None:
    """Checks that the named settings of a config are those of the run."""
    spec = gym.registry.get(_bare(run.config.env))
    registered = {} if spec is None else spec.kwargs
    for name in names:
        wanted = getattr(config, name)
        # An environment object has all arguments, including those its id is registered with.
        if name == "env_kwargs" and {**registered, **run.config.env_kwargs} == {**registered, **wanted}:
            continue
        if replace_checked(run.config, **{name: wanted}) != run.config:
            raise _differs(name, getattr(run.config, name), wanted)


def _differs(name: str, expected: Any, got: Any) -> ValueError:
    return ValueError(
        f"{name} must be that of the run to resume, {shown(expected)}, got {shown(got)}: of the settings, only "
        "episodes may change"
    )


def _id(env: Any) -> str | None:
    """Returns the id of an environment, or the name of its class; None if ``env`` is not an environment."""
    if isinstance(env, str):
        return versioned(env)
    if isinstance(env, gym.Env):
        return type(env.unwrapped).__name__ if env.spec is None else env.spec.id
    return env.id if isinstance(env, EnvSpec) else None


def _bare(env: str) -> str:
    """Returns an id without its package."""
    return env.rpartition(":")[2]


def snapshots_of(options: TrainingOptions, total: int, earlier: Run) -> tuple[int, ...]:
    """Returns the episodes of all snapshots of a resumed run of ``total`` episodes, the earlier part's first.

    Raises:
        TypeError: if ``options.snapshots`` is neither an integer nor a sequence of integers.
        ValueError: if a number in ``options.snapshots`` is out of range, or names an episode already finished.
    """
    to_take = () if earlier.state is None else earlier.state.snapshots
    finished = len(earlier.episode_returns)
    return resumed_snapshot_episodes(options.snapshots, total, finished, earlier.snapshots, to_take)


def counts_visits(run: Run, visits: Any) -> bool:
    """Returns whether a resumed run continues to count visits.

    Args:
        run: The earlier part.
        visits: The argument ``visits`` of the call.

    Raises:
        TypeError: if ``visits`` is not a boolean.
        ValueError: if ``visits`` is True, and the earlier part did not count visits.
    """
    if checks.boolean("visits", visits) and run.visits is None:
        raise ValueError("visits must be False: the run to resume did not count the visits of its first episodes")
    return run.visits is not None


def _config(name: str, run: Run, episodes: Any) -> Config:
    """Returns the config of the whole run."""
    finished = len(run.episode_returns)
    if run.state is None:
        raise ValueError(
            f"{name} must have the state of its training, which runs of train_many and files of earlier versions "
            "lack; qtab.train(..., initial_q=run.q_table) continues to learn from its table"
        )
    count = run.config.episodes if episodes is None else checks.count("episodes", episodes, least=1)
    if count <= finished:
        raise ValueError(f"episodes must be more than the {finished:,} that the run has finished, got {episodes!r}")
    return run.config if count == run.config.episodes else run.config.replace(episodes=count)
