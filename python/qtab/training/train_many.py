"""``qtab.train_many``: trains one config with many seeds, on all cores."""

import math
import os
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing, suppress
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray
from typing_extensions import Unpack

from qtab import _core
from qtab._spec import Results
from qtab._utils import checks
from qtab._utils.attach import attach
from qtab._utils.memory import BYTES_PER_EPISODE, BYTES_PER_RUN, check_memory, memory_left
from qtab._utils.shown import counted, shown
from qtab._utils.versions import versions
from qtab.config import Config
from qtab.config.choices import INSISTING
from qtab.config.help import with_settings
from qtab.config.merge import collect
from qtab.config.settings import SharedSettings
from qtab.discretizers.assigned_rows import AssignedRows
from qtab.envs.in_rust.matching import equal_environments
from qtab.results.runs import Runs
from qtab.training.runs_progress import RunsCallback, RunsReporter, train_in_parts
from qtab.training.setup.environment import mask_bytes
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import ResolvedRun, log_default_limit, log_python_stepping
from qtab.training.setup.run_env import resolve_over
from qtab.training.setup.run_memory import bytes_in_progress, tables_shape

MakeEnv: TypeAlias = Callable[[], gym.Env]


@with_settings
def train_many(
    env: str | EnvSpec | MakeEnv | None = None,
    seeds: int | Iterable[int] = 1000,
    *,
    config: Config | Mapping[str, Any] | None = None,
    threads: int | None = None,
    tables: bool = False,
    memory_limit: int | None = None,
    callback: RunsCallback | Sequence[RunsCallback] | None = None,
    callback_every: int | None = None,
    progress: bool | None = None,
    **settings: Unpack[SharedSettings],
) -> Runs:
    """Trains one agent per seed. Run ``i`` equals ``train(env, seed=seeds[i], ...)`` bit for bit for any ``threads``.

    Environments in Rust run on threads, without Python's interpreter lock. Those stepped in Python run in processes;
    as always with :mod:`multiprocessing`, a script then needs ``if __name__ == "__main__":`` around its call.

    Args:
        env: An environment's id, its EnvSpec, or a function that makes one and is called several times. None takes the
            environment of ``config``.
        seeds: The seeds of the runs; an integer N means 0 to N - 1.
        config: The settings to start from, as for :func:`qtab.train`, without the seed.
        threads: The number of threads or processes; None means one per core.
        tables: Whether to keep the Q tables.
        memory_limit: The number of bytes that the runs may take; None means half of the machine's memory, but no
            more than is free.
        callback: A callable, or a sequence of them, called with a :class:`qtab.RunsProgress` whenever more runs are
            finished, and after the last one. Any of them stops the training by returning False.
        callback_every: The number of runs between two calls; None calls about once a second.
        progress: Whether to show a progress bar. None shows one on a terminal or in a notebook if the runs take more
            than a second.
        **settings: The settings that all runs share, explained below.

    Returns:
        The runs. ``runs.completed`` is False if a callback stopped the training; only finished runs are included.

    Raises:
        gymnasium.error.Error: raised by Gymnasium for an unknown environment id.
        MemoryError: before the first run, if the runs would take more than ``memory_limit``; during the runs, if the
            episodes or models that their algorithm stores exceed the limit.
        TypeError: for an argument of the wrong type, an unknown one, or an environment instead of a function.
        ValueError: for an argument out of range, or a repeated seed.
        OverflowError: if the values of a run diverge.
        KeyboardInterrupt: on Ctrl-C. Like any exception that a run raises, it carries the finished runs as ``.run``.
    """
    reporter = RunsReporter(callback, callback_every, progress)
    tables = checks.boolean("tables", tables)
    numbers = seed_sequence(seeds, memory_limit)
    workers = thread_count(threads)
    env, base = collect(train_many, env, config, settings)
    # The bit generator may reject the largest seed.
    largest = numbers[-1] if isinstance(numbers, range) else max(numbers)
    template, env, overrides = resolve_over(env, base, {**settings, "seed": largest}, resolve_template)
    resolved = template.with_seed(numbers[0])
    log_default_limit(resolved)
    log_python_stepping(resolved)
    if tables and isinstance(resolved.discretizer, AssignedRows):
        raise ValueError("tables must be left out with max_rows: each run assigns the rows of its table differently")
    began = time.perf_counter()

    def make_runs(finished: NDArray[np.bool_]) -> Runs:
        return _runs(resolved, numbers, results, finished, tables, began)

    results, memory = allocate_results(resolved, len(numbers), min(workers, len(numbers)), tables, memory_limit)
    try:
        with reporter.start(numbers, results, make_runs):
            if not resolved.is_native:
                from qtab.training.process_pool import train_in_processes

                failed = train_in_processes(env, overrides, numbers, results, workers, memory, reporter.report)
            elif reporter.is_used:
                failed = train_in_parts(resolved, numbers, results, workers, memory, reporter)
            else:
                failed = train_in_threads(resolved, numbers, results, workers, memory, keep_going=False)
        for index, error in failed:
            if hasattr(error, "add_note"):
                error.add_note(f"in the run with seed {numbers[index]}")
            raise error
    except BaseException as error:
        with suppress(MemoryError):  # if the copies do not fit either, raise the error without them
            finished = make_runs(results["finished"])
            attach(error, run=finished, runs=finished)
        raise
    return make_runs(results["finished"])


def seed_sequence(seeds: Any, limit: int | None = None) -> Sequence[int]:
    """Returns the seeds as Python integers; an integer N becomes ``range(N)``.

    Args:
        seeds: The seeds, as given by the user.
        limit: The ``memory_limit`` that the user gave for all runs, or None.

    Raises:
        MemoryError: if even the shortest runs of so many seeds would exceed the limit.
        TypeError: if a seed is not an integer.
        ValueError: if there is no seed, a seed is negative, or a seed appears twice.
    """
    if hasattr(seeds, "__index__") and not np.ndim(seeds):  # an array has an __index__ too
        count = checks.integer("seeds", seeds, least=1)
        check_memory(counted(count, "run"), count * BYTES_PER_RUN, limit)
        return range(count)
    if not checks.is_sequence(seeds):
        raise TypeError(f"seeds must be an integer or a sequence of integers, got {shown(seeds)}")
    numbers: dict[int, None] = {}
    for index, seed in enumerate(seeds):
        number = checks.integer(f"seeds[{index}]", seed, least=0)
        if number in numbers:
            raise ValueError(f"seeds must differ from each other, got {number} twice")
        numbers[number] = None
        check_memory(f"more than {counted(len(numbers) - 1, 'run')}", len(numbers) * BYTES_PER_RUN, limit)
    if not numbers:
        raise ValueError("seeds must hold at least one seed, got none")
    return tuple(numbers)


def seed_numbers(seeds: Any) -> tuple[int, ...]:
    """Returns a tuple of the seeds; see :func:`seed_sequence`."""
    return tuple(seed_sequence(seeds))


def thread_count(threads: int | None) -> int:
    """Returns the number of threads to use: by default one for each core available to this process.

    Raises:
        TypeError: if ``threads`` is not an integer.
        ValueError: if ``threads`` is less than one, or more than a process can have.
    """
    if threads is not None:
        return checks.threads(threads)
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def resolve_template(env: str | EnvSpec | MakeEnv, settings: Mapping[str, Any]) -> ResolvedRun:
    """Resolves a run that the others differ from only by their seed; its environment is closed again.

    Raises:
        TypeError: for a single environment, which several runs cannot share.
    """
    if isinstance(env, gym.Env):
        raise TypeError(
            "env must be an id, an EnvSpec or a function that makes an environment: runs cannot share an environment"
        )
    made: Any = env
    if callable(env):
        made = env()
        if not isinstance(made, gym.Env):
            raise TypeError(f"env must make an environment, got {shown(made)}")
    resolved = resolve(made, settings, owns_env=True)
    resolved.close()
    if callable(env) and resolved.is_native and not _makes_equals(env, made):
        if (backend := settings.get("backend")) in INSISTING:
            raise ValueError(
                f"env must make equal environments at every call for backend {backend!r}, got two that differ"
            )
        # Each run then makes an environment, in a separate process.
        resolved = resolve(env(), {**settings, "backend": "gymnasium"}, owns_env=True)
        resolved.close()
    return resolved


def _makes_equals(make_env: MakeEnv, made: gym.Env) -> bool:
    with closing(make_env()) as another:
        return equal_environments(made, another)


def allocate_results(
    resolved: ResolvedRun, runs: int, at_once: int, keep_tables: bool, limit: int | None = None
) -> tuple[Results, tuple[int, int]]:
    """Returns arrays for the results of many runs, the limit, and the bytes left for data that grows during the runs.

    Args:
        resolved: One of the runs.
        runs: The number of runs.
        at_once: The number of runs trained at the same time.
        keep_tables: Whether to keep the Q tables.
        limit: The ``memory_limit`` that the user gave for the results and the runs in progress, or None.

    Raises:
        MemoryError: if the results and the runs in progress would exceed the limit.
    """
    episodes = resolved.config.episodes
    values = math.prod(tables_shape(resolved, 1))
    unknown_masks = resolved.masks is not None and resolved.masks.known is None
    keep_masks = unknown_masks and keep_tables and resolved.discretizer.has_cells
    masks = mask_bytes(resolved.discretizer, len(resolved.actions)) if keep_masks else 0
    stored = BYTES_PER_RUN + episodes * BYTES_PER_EPISODE + (8 * values if keep_tables else 0) + masks
    needed = runs * stored + at_once * bytes_in_progress(resolved)
    check_memory(f"{counted(runs, 'run')} of {counted(episodes, 'episode')}", needed, limit)
    results: Results = {
        "returns": np.zeros((runs, episodes)),
        "lengths": np.zeros((runs, episodes), dtype=np.int64),
        "terminated": np.empty((runs, episodes), dtype=np.bool_),
        "tables": np.empty((runs, values if keep_tables else 0)),
        "finished": np.zeros(runs, dtype=np.bool_),
        "masks": np.ones((runs, masks), dtype=np.bool_),
    }
    return results, memory_left(needed, limit)


def train_in_threads(
    resolved: ResolvedRun,
    seeds: Sequence[int],
    results: Results,
    threads: int,
    memory: tuple[int, int],
    *,
    keep_going: bool,
) -> list[tuple[int, Exception]]:
    """Trains a native environment with many seeds; returns the index and the error of each failed run.

    Unless ``keep_going`` is set, the first failure ends all runs.
    """
    return _core.train_many(resolved.spec(), seeds, results, threads, keep_going, memory)


def _runs(
    resolved: ResolvedRun,
    seeds: Sequence[int],
    results: Results,
    finished: NDArray[np.bool_],
    keep_tables: bool,
    began: float,
) -> Runs:
    completed = bool(finished.all())
    rows = slice(None) if completed else finished  # a slice copies nothing
    tables = results["tables"][rows]
    return Runs(
        config=resolved.config,
        seeds=tuple(seed for seed, done in zip(seeds, finished, strict=True) if done),
        episode_returns=results["returns"][rows],
        episode_lengths=results["lengths"][rows],
        terminated=results["terminated"][rows],
        tables=tables.reshape(tables_shape(resolved, len(tables))) if keep_tables else None,
        discretizer=resolved.discretizer,
        actions=resolved.actions,
        completed=completed,
        seconds=time.perf_counter() - began,
        versions=versions(),
        action_masks=_masks(resolved, results, rows) if keep_tables else None,
    )


def _masks(resolved: ResolvedRun, results: Results, rows: Any) -> NDArray[np.bool_] | None:
    """Returns (runs, *cells, actions): the masks, which are known from the start in Rust; None without masks."""
    shape = (*resolved.discretizer.shape, len(resolved.actions))
    runs = len(results["finished"][rows])
    if resolved.masks is not None and resolved.masks.known is not None:
        return np.broadcast_to(resolved.masks.known.reshape(shape), (runs, *shape))
    return results["masks"][rows].reshape(runs, *shape) if results["masks"].shape[1] else None
