"""Settings and runs of a sweep, planned and trained again."""

from collections.abc import Sequence
from contextlib import closing
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from qtab._utils import checks
from qtab.config import Config
from qtab.config.merge import over
from qtab.config.origin import Origin, copied
from qtab.envs.origin.description import differences
from qtab.envs.origin.values import with_types
from qtab.results.run import Run
from qtab.results.summary import summarize
from qtab.sweeps.run_versions import differing
from qtab.sweeps.study import Study
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import ResolvedRun
from qtab.training.setup.run_env import as_in_training, environment_of
from qtab.training.train import train_resolved
from qtab.training.train_many import resolve_template

if TYPE_CHECKING:
    from qtab.sweeps.results import Sweep


def trained_again(sweep: "Sweep", setting: int, seed: int, env: Any) -> Run:
    """Trains a run of a sweep again; see :meth:`qtab.Sweep.run`.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, a run that failed or is not finished, or one that gives other results
            here.
    """
    rows, seed = sweep.rows(setting), checks.integer("seed", seed, least=0)
    found = [int(row) for row in rows if int(sweep.columns["seed"][row]) == seed]
    if not found:
        raise ValueError(f"seed must be that of a finished run of setting {setting}, got {seed}")
    if (error := sweep.columns["error"][found[0]]) is not None:
        raise ValueError(f"the run of setting {setting} with seed {seed} failed: {error}")
    study = plan_again(sweep, [int(setting)], (seed,), env)
    made = study.env() if callable(study.env) else study.env
    with closing(resolve(made, {**study.overrides[0], "seed": seed}, owns_env=True)) as resolved:
        run = train_resolved(resolved)
    columns = summarize(run.episode_returns[np.newaxis], run.episode_lengths[np.newaxis], run.terminated[np.newaxis])
    others = ", ".join(differing(sweep.run_versions[found[0]])) if sweep.run_versions else ""
    for name, values in columns.items():
        here, there = float(values[0]), float(sweep.columns[name][found[0]])
        if here != there:
            raise ValueError(
                f"the run of setting {setting} with seed {seed} is different here: {name} is {here}, "
                f"in the sweep {there}{f', which was trained with {others}' if others else ''}"
            )
    return run


def plan_again(sweep: "Sweep", chosen: Sequence[int], numbers: tuple[int, ...], env: Any) -> Study:
    """Returns the study that trains settings of a sweep again.

    Args:
        sweep: The sweep.
        chosen: The indices of the settings.
        numbers: The seeds.
        env: The environment; None takes that of the sweep.

    Raises:
        TypeError: if ``env`` is an environment, which several runs cannot share.
        ValueError: if the settings cannot be restored here, or their environment differs or cannot be made again.
    """
    if sweep._source is not None:
        made = sweep._source[0] if env is None else env
        overrides = [sweep._source[1][index] for index in chosen]
    else:
        configs = [_restored(sweep, index) for index in chosen]
        made = _made_again(configs[0]) if env is None else env
        # A function passes the arguments to the environment itself.
        own: dict[str, Any] = {"env_kwargs": {}} if callable(made) else {}
        overrides = [{**over(config, {}), **own} for config in configs]
    resolved = [resolve_template(made, {**given, "seed": max(numbers)}) for given in overrides]
    for index, run in zip(chosen, resolved, strict=True):
        _check_environment(sweep, index, run)
    study = Study(made, [sweep.settings[index] for index in chosen], overrides, numbers, resolved, sweep.block)
    for index, config in zip(chosen, study.stored.configs, strict=True):
        different = [
            name for name, value in config.items() if name != "env" and value != sweep.configs[index].get(name)
        ]
        if different:
            raise ValueError(f"setting {index} cannot be restored here: it would have another {different[0]}")
    return study


def _made_again(config: Config) -> Any:
    """Returns the environment of a config from a store: the spec of its id, or a function that makes it as it was.

    A store must not select a module to import.
    """
    spec = gym.registry.get(config.env.rpartition(":")[2])
    if spec is None:
        raise ValueError(
            f"the environment {config.env!r} of the store must be registered, or given as env=, but it is not"
        )

    def attempt(env: Any, settings: dict[str, Any]) -> ResolvedRun:
        return resolve_template(spec if isinstance(env, str) else env, settings)

    _, made, _ = as_in_training(config, over(config, {}), attempt)
    return spec if isinstance(made, str) else made


def _restored(sweep: "Sweep", setting: int) -> Config:
    """Returns the config of a setting from a store, with its environment as far as the store describes it."""
    stored, environment = sweep.configs[setting], sweep._environments.get(setting)
    if isinstance(stored["initial_q"], dict):
        raise ValueError("a store does not keep an array initial_q; use the table that qtab.sweep returned")
    if environment is None:
        return Config(**stored)
    kwargs = with_types(stored["env_kwargs"], environment.kwargs)
    return copied(Config(**{**stored, "env_kwargs": kwargs}), Origin(environment))


def _check_environment(sweep: "Sweep", setting: int, resolved: ResolvedRun) -> None:
    """Checks that a setting is trained again in its own environment, as far as that is known.

    Raises:
        ValueError: if the environment differs; the message lists the differences.
    """
    environment = sweep._environments.get(setting)
    if environment is not None and (found := differences(environment, environment_of(resolved))):
        raise ValueError(f"env must be that of setting {setting} of the sweep, got another one: {'; '.join(found)}")
