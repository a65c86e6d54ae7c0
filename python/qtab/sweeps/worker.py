"""Trains the chunks of a sweep, in this process or a worker, and predicts the number of runs that take a second."""

import math
import pickle
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils.memory import memory_left
from qtab._utils.versions import versions
from qtab.results.summary import block_means, summarize
from qtab.sweeps.run_records import RunRecord
from qtab.training.process_pool import trained_in_python
from qtab.training.setup.resolved_run import ResolvedRun
from qtab.training.setup.run_memory import bytes_of_run
from qtab.training.train_many import allocate_results, resolve_template, train_in_threads

if TYPE_CHECKING:
    from qtab.sweeps.store import Store
    from qtab.sweeps.study import Study

CHUNK_SECONDS = 1.0
"""The time between two commits. An interruption loses no more than this, unless single runs take longer."""
MAX_CHUNK_RUNS = 4096
"""The maximum number of runs in a chunk."""
TYPICAL_MAX_STEPS = 1000
"""The expected maximum number of steps of an episode whose time limit is longer."""
CAUTION = 4.0
"""The factor by which a new setting may take longer than predicted from the previous one."""

Part = tuple[int, Mapping[str, Any], ResolvedRun | None, Sequence[int]]
"""The index of a setting, its overrides, its resolved config (None to resolve it here), and seeds."""


@dataclass
class Pace:
    """Predicts the time of runs from earlier runs.

    Estimates of the steps of a run make the times of different settings comparable. Predictions never change results;
    they only decide when results are stored.
    """

    seconds_per_step: float | None = None
    """The time per estimated step in the last runs; None before the first run."""
    setting: int | None = None
    """The setting of the last runs."""

    def record(self, setting: int, resolved: ResolvedRun, runs: int, seconds: float) -> None:
        """Records the total time of runs of a setting."""
        self.setting, self.seconds_per_step = setting, max(seconds, 1e-9) / (runs * _steps(resolved))

    def runs(self, setting: int, resolved: ResolvedRun, seconds: float, at_least: int = 1) -> int:
        """Returns the number of runs of a setting that are expected to take ``seconds`` seconds."""
        if self.seconds_per_step is None:
            return min(at_least, MAX_CHUNK_RUNS)
        predicted = self.seconds_per_step * _steps(resolved) * (1.0 if setting == self.setting else CAUTION)
        return min(max(int(min(seconds / predicted, MAX_CHUNK_RUNS)), at_least), MAX_CHUNK_RUNS)


def _steps(resolved: ResolvedRun) -> int:
    """Returns the estimated steps of a run."""
    return resolved.config.episodes * min(resolved.max_episode_steps, TYPICAL_MAX_STEPS)


def claim_size(study: "Study", pace: Pace, at_least: int, start: int) -> int:
    """Returns the number of runs of a study, from index ``start``, that are expected to take about a second.

    A few runs too many do no harm: the training stops after a second, and releases the rest of a claim.
    """
    count = len(study.seeds)
    size, left = 0, CHUNK_SECONDS
    while size < MAX_CHUNK_RUNS and start + size < study.runs:
        setting = (start + size) // count
        of_setting = (setting + 1) * count - start - size
        predicted = pace.runs(setting, study.resolved[setting], left, at_least)
        size += min(of_setting, predicted)
        if predicted <= of_setting:
            break
        left *= 1 - of_setting / predicted
    return min(size, MAX_CHUNK_RUNS)


def train_chunk(task: bytes) -> tuple[list[RunRecord], float, Pace, dict[str, str]]:
    """Trains the first runs of a chunk on one thread, for about a second; see :func:`train_parts`.

    Args:
        task: ``(env, [(setting, overrides, seeds), ...], block, memory_limit, pace)``, pickled by cloudpickle.

    Returns:
        The records, the training time in seconds, the pace, and the versions of this process.
    """
    env, parts, block, limit, pace = pickle.loads(task)  # noqa: S301 - from the process that submitted it
    began = time.perf_counter()
    unresolved = [(setting, overrides, None, seeds) for setting, overrides, seeds in parts]
    records = train_parts(env, unresolved, block, 1, limit, pace)
    return records, time.perf_counter() - began, pace, versions()


def train_claim(study: "Study", store: "Store", claim: range, threads: int, pace: Pace) -> None:
    """Trains the first runs of a claim in this process, for about a second, and stores them."""
    parts = [
        (setting, study.overrides[setting], study.resolved[setting], seeds) for setting, seeds in study.split(claim)
    ]
    began = time.perf_counter()
    records = train_parts(study.env, parts, study.block, threads, study.memory_limit, pace)
    store.commit(claim, records, time.perf_counter() - began)


def train_parts(
    env: Any, parts: Sequence[Part], block: int, threads: int, memory_limit: int | None, pace: Pace
) -> list[RunRecord]:
    """Trains runs in order for about a second, and at least one; returns the records of the trained runs."""
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
            records += train_setting(env, overrides, resolved, batch, block, threads, memory_limit)
            pace.record(setting, resolved, len(batch), time.perf_counter() - before)
            trained += len(batch)
    return records


def train_setting(
    env: Any,
    overrides: Mapping[str, Any],
    resolved: ResolvedRun,
    seeds: Sequence[int],
    block: int,
    threads: int,
    memory_limit: int | None,
) -> list[RunRecord]:
    """Trains one setting with each seed. The error of a run that fails is recorded, and the other runs continue.

    A run fails only if it needs more than ``memory_limit`` alone, so that results do not depend on ``threads``.
    """
    memory = memory_left(bytes_of_run(resolved), memory_limit)
    if not resolved.is_native:
        return [_train_in_python(env, overrides, seed, block, memory) for seed in seeds]
    results, _ = allocate_results(resolved, len(seeds), threads, keep_tables=False, limit=2**63)
    failed = dict(train_in_threads(resolved, seeds, results, threads, memory, keep_going=True))
    records = _records(seeds, block, results["returns"], results["lengths"], results["terminated"])
    for index, error in failed.items():
        records[index] = _failure(seeds[index], error)
        if isinstance(error, MemoryError) and len(seeds) > 1:  # the runs shared the memory limit of one
            (records[index],) = train_setting(env, overrides, resolved, [seeds[index]], block, 1, memory_limit)
    return records


def _train_in_python(
    env: Any, overrides: Mapping[str, Any], seed: int, block: int, memory: tuple[int, int]
) -> RunRecord:
    try:
        with trained_in_python(env, overrides, seed, memory) as (_, trainer):
            returns, lengths, terminated = (column[np.newaxis] for column in trainer.episodes())
            return _records([seed], block, returns, lengths, terminated)[0]
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
