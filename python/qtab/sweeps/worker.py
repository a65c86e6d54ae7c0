"""Training of the chunks of a sweep, in this process or in a worker, whose results the caller stores."""

import math
import pickle
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab import _core
from qtab._utils.memory import memory_left, memory_limit
from qtab.results.summary import block_means, summarize
from qtab.sweeps.database import RunRecord
from qtab.sweeps.pace import CHUNK_SECONDS, Pace
from qtab.training.process_pool import train_unless_stopped
from qtab.training.resolve import resolve
from qtab.training.resolved_run import ResolvedRun
from qtab.training.train_many import allocate_results, resolve_template, train_in_threads

if TYPE_CHECKING:
    from qtab.sweeps.store import Store
    from qtab.sweeps.study import Study

Part = tuple[int, Mapping[str, Any], ResolvedRun | None, Sequence[int]]
"""The index of a setting, its overrides, its resolved config (None to resolve it here), and seeds."""


def train_chunk(task: bytes) -> tuple[list[RunRecord], float, Pace]:
    """Trains the first runs of a chunk on one thread, for about a second; see :func:`train_parts`.

    Args:
        task: ``(env, [(setting, overrides, seeds), ...], block, pace)``, pickled by cloudpickle.

    Returns:
        The records, the time that they took in seconds, and the pace.
    """
    env, parts, block, pace = pickle.loads(task)  # noqa: S301 - from the process that submitted it
    began = time.perf_counter()
    unresolved = [(setting, overrides, None, seeds) for setting, overrides, seeds in parts]
    records = train_parts(env, unresolved, block, threads=1, pace=pace)
    return records, time.perf_counter() - began, pace


def train_claim(study: "Study", store: "Store", claim: range, threads: int, pace: Pace) -> None:
    """Trains the first runs of a claim in this process, for about a second, and stores them."""
    parts = [
        (setting, study.overrides[setting], study.resolved[setting], seeds) for setting, seeds in study.split(claim)
    ]
    began = time.perf_counter()
    records = train_parts(study.env, parts, study.block, threads, pace)
    store.commit(claim, records, time.perf_counter() - began)


def train_parts(env: Any, parts: Sequence[Part], block: int, threads: int, pace: Pace) -> list[RunRecord]:
    """Trains runs in their order for about a second, and at least one; returns the records of those that it trained."""
    records: list[RunRecord] = []
    began = time.perf_counter()
    for setting, overrides, given, seeds in parts:
        try:
            resolved = given or resolve_template(env, {**overrides, "seed": seeds[0]})
        except Exception as error:
            records += [_failure(seed, error) for seed in seeds]
            continue
        trained = 0
        while trained < len(seeds):
            left = CHUNK_SECONDS - (time.perf_counter() - began)
            if records and left <= 0:
                return records
            batch = seeds[trained : trained + pace.runs(setting, resolved, left, at_least=threads)]
            before = time.perf_counter()
            records += train_setting(env, overrides, resolved, batch, block, threads)
            pace.record(setting, resolved, len(batch), time.perf_counter() - before)
            trained += len(batch)
    return records


def train_setting(
    env: Any, overrides: Mapping[str, Any], resolved: ResolvedRun, seeds: Sequence[int], block: int, threads: int
) -> list[RunRecord]:
    """Trains one setting with each seed. The error of a run that fails is recorded, and the other runs continue."""
    if not resolved.is_native:
        return [_train_in_python(env, overrides, seed, block) for seed in seeds]
    results, _ = allocate_results(resolved, len(seeds), threads, keep_tables=False, limit=2**63)
    memory = memory_left(0, memory_limit(None))
    failed = dict(train_in_threads(resolved, seeds, results, threads, memory, keep_going=True))
    records = _records(seeds, block, results["returns"], results["lengths"], results["terminated"])
    return [_failure(record.seed, failed[index]) if index in failed else record for index, record in enumerate(records)]


def _train_in_python(env: Any, overrides: Mapping[str, Any], seed: int, block: int) -> RunRecord:
    try:
        resolved = resolve(env() if callable(env) else env, {**overrides, "seed": seed}, owns_env=True)
        try:
            memory = memory_left(0, memory_limit(None))
            trainer = _core.Trainer(resolved.spec(), resolved.seed, memory=memory)
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
        _record(seed, {name: column[index] for name, column in columns.items()}, curves[index])
        for index, seed in enumerate(seeds)
    ]


def _record(seed: int, summary: dict[str, float | int], curve: Any) -> RunRecord:
    if all(map(math.isfinite, summary.values())) and np.isfinite(curve).all():
        return RunRecord(seed, summary, curve.tobytes())
    return _failure(seed, OverflowError("the means of the returns are not finite"))


def _failure(seed: int, error: Exception) -> RunRecord:
    return RunRecord(seed, None, b"", f"{type(error).__name__}: {error}")
