"""``qtab.sweep``: trains many settings with many seeds each; ``qtab.load_sweep``: reads the table of a store."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np
from gymnasium.envs.registration import EnvSpec
from typing_extensions import Unpack

from qtab._utils import checks
from qtab._utils.attach import attach
from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.config.help import with_settings
from qtab.config.merge import collect, over
from qtab.config.settings import SharedSettings
from qtab.envs.registry import spec_of
from qtab.sweeps.connection import store_path
from qtab.sweeps.environments import stored_environments
from qtab.sweeps.results import Sweep, build_sweep
from qtab.sweeps.run_records import SUMMARY_COLUMNS
from qtab.sweeps.store_format import read_store
from qtab.sweeps.study import plan_study
from qtab.sweeps.training import SweepProgress, run_study
from qtab.training.setup.resolved_run import log_default_limit
from qtab.training.setup.run_env import as_in_training
from qtab.training.train_many import MakeEnv, resolve_template

BLOCK = 100


@with_settings
def sweep(
    env: str | EnvSpec | MakeEnv | None,
    grid: Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]],
    seeds: int | Iterable[int] = 100,
    *,
    config: Config | Mapping[str, Any] | None = None,
    store: "str | os.PathLike[str] | None" = None,
    executor: Executor | None = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    block: int = BLOCK,
    callback: Callable[[SweepProgress], None] | None = None,
    progress: bool | None = None,
    **settings: Unpack[SharedSettings],
) -> Sweep:
    """Trains every setting of a grid with the same seeds.

    With a ``store``, an interrupted sweep resumes when it is called again. Called with more seeds than before, it
    trains only the new ones.

    Args:
        env: An environment's id, its EnvSpec, or a function that creates one. None takes that of ``config``.
        grid: Lists of values by the names of settings, to train every combination; or a list of settings, such as the
            result of :func:`qtab.designs.sobol`.
        seeds: The seeds of every setting; an integer N means 0 to N - 1.
        config: The settings to start from, as for :func:`qtab.train`, without the seed.
        store: An SQLite file for the results, which several processes may share. None keeps the results in memory.
            Later calls can add seeds, but not settings.
        executor: Trains the runs: any :class:`concurrent.futures.Executor`, such as Dask's ``client.get_executor()``.
            None trains on threads of this process, or in worker processes if Python steps the environment.
        threads: The number of threads or processes without an executor; None means one per core.
        memory_limit: The most memory that each single run may take, and the table of all runs, in bytes. It applies to
            each run separately, however many are trained at the same time, in any process. None means half of the
            memory of the machine that trains the run.
        block: The number of episodes that each point of a stored learning curve averages.
        callback: Called with a :class:`SweepProgress` about every second, after each stored chunk of runs.
        progress: Whether to show a progress bar. None shows one on a terminal or in a notebook if the runs take more
            than a second.
        **settings: The settings that all runs share, explained below.

    Returns:
        A table with one row per run. The column ``error`` has the errors of failed runs. The best of many settings
        looks better than it is: :meth:`Sweep.confirm` trains it again with other seeds.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        MemoryError: if a run or the table would need more than ``memory_limit``, before any training. A run fails if
            the episodes or the model that its algorithm stores exceed the limit.
        OSError: if the store cannot be written, or is deleted during the sweep.
        RuntimeError: if the executor fails; the message states the number of runs that are kept.
        StoreError: if the store is damaged, has another format version, or belongs to another sweep.
        TypeError: for an argument of the wrong type, or an unknown setting.
        ValueError: for an argument out of range.
        KeyboardInterrupt: on Ctrl-C. Like any exception after the training began, it carries the table of the finished
            runs as ``.run``.
    """
    try:
        block = checks.count("block", block, least=1)
        env, base = collect(sweep, env, config, settings)
        if isinstance(base, Config) and env == base.env:
            time_limit: Any = {name: value for name, value in settings.items() if name == "max_episode_steps"}
            _, env, _ = as_in_training(base, over(base, time_limit), resolve_template)
            base = base if isinstance(env, str) else replace_checked(base, env_kwargs={})
        if isinstance(env, str):
            env = spec_of(env)  # a worker process may not have imported the package that registers the id
        study = plan_study(env, grid, seeds, block, settings, base, memory_limit)
        for resolved in study.resolved:
            log_default_limit(resolved)
        return run_study(
            study, partial(build_sweep, study=study), store, executor, threads, memory_limit, callback, progress
        )
    except KeyboardInterrupt as error:
        if not hasattr(error, "run"):  # interrupted before training
            attach(error, run=_stored(store, env, block))
        raise


def _stored(store: Any, env: Any, block: int) -> Sweep:
    """Returns the results of earlier calls; an empty table if the sweep was interrupted before it was planned."""
    if store is not None:
        with suppress(Exception):
            return load_sweep(store)
    columns: dict[str, Any] = {"setting": np.empty(0, np.int64), "seed": np.empty(0, np.int64)}
    columns |= {name: np.empty(0) for name in SUMMARY_COLUMNS}
    columns["error"] = np.empty(0, dtype=object)
    return Sweep(str(getattr(env, "id", env)), (), (), columns, block, ())


def load_sweep(path: "str | os.PathLike[str]") -> Sweep:
    """Returns the finished runs of a store, which may belong to a sweep that is still running.

    The digests of the store are checked. A message is logged if the runs were trained with different versions, or if
    the store is from an earlier version of this package and does not hold the versions of each run.

    Raises:
        OSError: if the file does not exist or cannot be read.
        StoreError: if the file is not a store, is damaged or empty, or has another format version.
        TypeError: if ``path`` is not a path.
    """
    found = store_path(path)
    if not found.exists():
        raise FileNotFoundError(f"store not found: {str(found)!r}")
    contents = read_store(found)
    environments = stored_environments(contents.meta, len(contents.study.settings), found)
    return build_sweep(contents, environments=environments)
