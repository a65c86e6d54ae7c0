"""Training of the chunks of a sweep, in this process or in a worker; the results are stored by the caller."""

import pickle
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from qtab import _core
from qtab.results.summary import block_means, summarize
from qtab.sweeps.database import RunRecord
from qtab.training.process_pool import train_unless_stopped
from qtab.training.resolve import resolve
from qtab.training.resolved_run import ResolvedRun
from qtab.training.train_many import allocate_results, resolve_template, train_in_threads


def train_chunk(task: bytes) -> list[RunRecord]:
    """Trains the runs of a chunk on one thread.

    Args:
        task: ``(env, [(overrides, seeds), ...], block)``, pickled by cloudpickle.
    """
    env, parts, block = pickle.loads(task)  # noqa: S301 - from the process that submitted it
    records: list[RunRecord] = []
    for overrides, seeds in parts:
        try:
            resolved = resolve_template(env, {**overrides, "seed": seeds[0]})
        except Exception as error:
            records += [_failure(seed, error) for seed in seeds]
        else:
            records += train_setting(env, overrides, resolved, seeds, block, threads=1)
    return records


def train_setting(
    env: Any, overrides: Mapping[str, Any], resolved: ResolvedRun, seeds: Sequence[int], block: int, threads: int
) -> list[RunRecord]:
    """Trains one setting with each seed. The error of a run that fails is recorded, and the other runs continue."""
    if not resolved.is_native:
        return [_train_in_python(env, overrides, seed, block) for seed in seeds]
    results = allocate_results(resolved, len(seeds), threads, keep_tables=False, limit=2**63)
    failed = dict(train_in_threads(resolved, seeds, results, threads, keep_going=True))
    records = _records(seeds, block, results["returns"], results["lengths"], results["terminated"])
    return [_failure(record.seed, failed[index]) if index in failed else record for index, record in enumerate(records)]


def _train_in_python(env: Any, overrides: Mapping[str, Any], seed: int, block: int) -> RunRecord:
    try:
        resolved = resolve(env() if callable(env) else env, {**overrides, "seed": seed}, owns_env=True)
        try:
            trainer = _core.Trainer(resolved.spec(), resolved.seed)
            train_unless_stopped(trainer, resolved.config.episodes)
            returns, lengths, terminated = (column[np.newaxis] for column in trainer.episodes())
            return _records([seed], block, returns, lengths, terminated)[0]
        finally:
            resolved.close()
    except Exception as error:
        return _failure(seed, error)


def _records(seeds: Sequence[int], block: int, returns: Any, lengths: Any, terminated: Any) -> list[RunRecord]:
    columns = {name: column.tolist() for name, column in summarize(returns, lengths, terminated).items()}
    curves = block_means(returns, block)
    return [
        RunRecord(seed, {name: column[index] for name, column in columns.items()}, curves[index].tobytes())
        for index, seed in enumerate(seeds)
    ]


def _failure(seed: int, error: Exception) -> RunRecord:
    return RunRecord(seed, None, b"", f"{type(error).__name__}: {error}")
