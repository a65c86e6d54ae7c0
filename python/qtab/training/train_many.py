"""``qtab.train_many``: one config, many seeds, all cores."""

import os
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from typing_extensions import Unpack

from qtab import _core, _spec
from qtab._utils import checks
from qtab._utils.memory import BYTES_PER_EPISODE, check_memory, memory_limit
from qtab._utils.versions import versions
from qtab.config import Config
from qtab.config.layers import collect, over
from qtab.config.settings import SharedSettings
from qtab.config.signature import with_settings
from qtab.results.runs import Runs
from qtab.training.resolve import Resolved, log_default_limit, resolve

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
    **settings: Unpack[SharedSettings],
) -> Runs:
    """Trains one agent per seed. Run ``i`` equals ``train(env, seed=seeds[i], ...)`` to the bit for any ``threads``.

    Environments in Rust run on threads, without Python's interpreter lock. Those stepped in Python run in processes. As
    always with :mod:`multiprocessing`, a script then needs ``if __name__ == "__main__":`` around its call.

    Args:
        env: An environment's id, its EnvSpec, or a function that makes one. None takes the environment of ``config``.
        seeds: The seeds of the runs; an integer N means 0 to N - 1.
        config: The settings to start from, as for :func:`qtab.train`, without the seed.
        threads: The number of threads or processes; None means one per core.
        tables: Whether to keep the Q tables.
        memory_limit: The number of bytes that the runs may take; None means half of the machine's memory.
        **settings: The settings that all runs share, explained below.

    Raises:
        gymnasium.error.Error: raised by Gymnasium for an unknown environment id.
        MemoryError: before the first run, if they would take more than ``memory_limit``.
        TypeError: for an argument of the wrong type, an unknown one, or an environment instead of a function.
        ValueError: for an argument out of range, or a repeated seed.
        KeyboardInterrupt: on Ctrl-C. Like any exception that a run raises, it carries the finished runs as ``.run``.
    """
    numbers = seed_numbers(seeds)
    workers = thread_count(threads)
    env, base = collect(train_many, env, config, settings)
    overrides = over(base, settings)
    resolved = resolve_one(env, {**overrides, "seed": numbers[0]})
    log_default_limit(resolved)
    resolved.config.replace(seed=max(numbers))
    limit = _limit(memory_limit)
    began = time.perf_counter()
    results = allocate(resolved, len(numbers), min(workers, len(numbers)), tables, limit)
    try:
        if resolved.model is not None:
            failed = train_in_threads(resolved, numbers, results, workers, keep_going=False)
        else:
            from qtab.training.process_pool import train_in_processes

            failed = train_in_processes(env, overrides, numbers, results, workers)
        for index, error in failed:
            if hasattr(error, "add_note"):
                error.add_note(f"in the run with seed {numbers[index]}")
            raise error
    except BaseException as error:
        error.run = error.runs = _runs(resolved, numbers, results, tables, began)  # type: ignore[attr-defined]
        raise
    return _runs(resolved, numbers, results, tables, began)


def seed_numbers(seeds: Any) -> tuple[int, ...]:
    """Returns the seeds as Python integers.

    Raises:
        TypeError: if they are none.
        ValueError: if there are none, one is negative, or one comes twice.
    """
    if hasattr(seeds, "__index__") and not np.ndim(seeds):  # an array has an __index__ too
        return tuple(range(checks.integer("seeds", seeds, least=1)))
    if isinstance(seeds, (str, bytes)) or not hasattr(seeds, "__iter__"):
        raise TypeError(f"seeds must be an integer or a sequence of integers, got {seeds!r}")
    numbers = tuple(checks.integer("seeds", seed, least=0) for seed in seeds)
    if not numbers:
        raise ValueError("seeds must hold at least one seed, got none")
    if len(set(numbers)) < len(numbers):
        twice = next(seed for index, seed in enumerate(numbers) if seed in numbers[:index])
        raise ValueError(f"seeds must differ from each other, got {twice} twice")
    return numbers


def thread_count(threads: int | None) -> int:
    """Returns how many threads to use: one a core that this process may run on, where none is said.

    Raises:
        TypeError: if it is no integer.
        ValueError: if it is less than one, or more than a process can have.
    """
    if threads is not None:
        return checks.threads(threads)
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def resolve_one(env: str | EnvSpec | MakeEnv, overrides: dict[str, Any]) -> Resolved:
    """Returns what one of the runs comes to, its environment closed again.

    Raises:
        TypeError: for a single environment, which several runs cannot share.
    """
    if isinstance(env, gym.Env):
        raise TypeError(
            "env must be an id, an EnvSpec or a function that makes an environment: many runs cannot share one"
        )
    made = None if isinstance(env, str | EnvSpec) or not callable(env) else env()
    if made is not None and not isinstance(made, gym.Env):
        raise TypeError(f"env must make an environment, got {made!r}")
    try:
        resolved = resolve(env if made is None else made, overrides)  # type: ignore[arg-type]
    except BaseException:
        if made is not None:
            made.close()
        raise
    if resolved.env is not None:
        resolved.env.close()
    elif made is not None:
        made.close()
    return resolved


def allocate(resolved: Resolved, runs: int, alive: int, tables: bool, limit: int) -> _spec.Results:
    """Returns where the results go; ``alive`` runs are underway at a time.

    Raises:
        MemoryError: if results and tables need more than the limit.
    """
    episodes = resolved.config.episodes
    values = resolved.grid.rows * resolved.grid.actions
    needed = runs * episodes * BYTES_PER_EPISODE + alive * (episodes * BYTES_PER_EPISODE + 8 * values)
    what = f"{runs} runs of {episodes} episodes"
    check_memory(what, needed + (runs * 8 * values if tables else 0), limit)
    if tables and resolved.model is not None:
        # Some learners have several tables.
        values = _core.Trainer(resolved.spec(), resolved.seed).tables().size
        check_memory(what, needed + runs * 8 * values, limit)
    return {
        "returns": np.zeros((runs, episodes)),
        "lengths": np.zeros((runs, episodes), dtype=np.int64),
        "terminated": np.empty((runs, episodes), dtype=np.bool_),
        "tables": np.empty((runs, values if tables else 0)),
        "finished": np.zeros(runs, dtype=np.bool_),
    }


def train_in_threads(
    resolved: Resolved, seeds: tuple[int, ...], results: _spec.Results, threads: int, *, keep_going: bool
) -> list[tuple[int, Exception]]:
    """Trains a model in Rust; returns the runs that failed. Nothing is begun after the first unless ``keep_going``."""
    return _core.train_many(resolved.spec(), seeds, results, threads, keep_going)


def _runs(resolved: Resolved, seeds: tuple[int, ...], results: _spec.Results, tables: bool, began: float) -> Runs:
    finished = results["finished"]
    whole = bool(finished.all())
    rows = slice(None) if whole else finished
    shape = (-1, resolved.grid.rows, resolved.grid.actions)
    kept = results["tables"][rows]
    return Runs(
        config=resolved.config,
        seeds=tuple(seed for seed, done in zip(seeds, finished, strict=True) if done),
        episode_returns=results["returns"][rows],
        episode_lengths=results["lengths"][rows],
        terminated=results["terminated"][rows],
        tables=kept.reshape(len(kept), *shape) if tables else None,
        grid=resolved.grid,
        completed=whole,
        seconds=time.perf_counter() - began,
        versions=versions(),
    )


_limit = memory_limit
