"""Chunks are measured by time, and do not change results."""

from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab
from qtab.sweeps import study as studies
from qtab.sweeps import worker
from qtab.sweeps.study import plan_study
from support.parity import run_of
from support.sweeps import CAR, GRID, SMALL, assert_equal


class _Clock:
    """A clock on which every run takes some seconds."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.now = seconds, 0.0

    def perf_counter(self) -> float:
        return self.now


def with_seconds(monkeypatch: pytest.MonkeyPatch, seconds: float) -> None:
    clock, train = _Clock(seconds), worker.train_setting

    def train_setting(
        env: Any, overrides: Any, resolved: Any, seeds: Any, block: int, threads: int, memory_limit: int | None
    ) -> Any:
        clock.now += clock.seconds * len(seeds) / threads
        return train(env, overrides, resolved, seeds, block, threads, memory_limit)

    monkeypatch.setattr(worker, "time", clock)
    monkeypatch.setattr(worker, "train_setting", train_setting)


@pytest.mark.parametrize(("seconds", "chunks"), [(0.4, (6, 12)), (100.0, (15, 30)), (1e-6, (1, 3))])
def test_progress_moves_about_every_second(monkeypatch, seconds, chunks):
    with_seconds(monkeypatch, seconds)
    seen: list[qtab.SweepProgress] = []
    study = qtab.sweep(CAR, GRID, threads=2, callback=seen.append, **SMALL)
    assert chunks[0] <= len(seen) <= chunks[1]
    # Two threads train two runs at least; as many as fit into a second, at most.
    assert max(after.runs - before.runs for before, after in pairwise(seen)) <= max(2, 2 / seconds + 2)
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))


def test_an_interrupted_sweep_of_slow_runs_keeps_those_before(monkeypatch):
    with_seconds(monkeypatch, 1.0)
    seen: list[int] = []

    def interrupt(progress: qtab.SweepProgress) -> None:
        seen.append(progress.runs)
        if progress.runs >= 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        qtab.sweep(CAR, GRID, threads=1, callback=interrupt, **SMALL)
    assert seen == [1, 2, 3, 4]
    assert len(run_of(caught.value)) == 4


@given(seconds=st.floats(1e-12, 1e12), left=st.floats(-10, 10), at_least=st.integers(1, 5000))
def test_a_prediction_is_a_possible_number_of_runs(seconds, left, at_least):
    study = plan_study(CAR, {"learning_rate": [0.1, 0.2]}, 3, 100, {"episodes": 40})
    measured = worker.Pace()
    measured.record(0, study.resolved[0], 2, seconds)
    for setting in (0, 1):
        runs = measured.runs(setting, study.resolved[setting], left, at_least)
        assert min(at_least, worker.MAX_CHUNK_RUNS) <= runs <= worker.MAX_CHUNK_RUNS


@given(start=st.integers(0, 29), seconds=st.floats(1e-9, 10), seeds=st.integers(1, 9))
def test_a_claim_lies_within_the_study(start, seconds, seeds):
    study = plan_study(CAR, GRID, seeds, 100, {"episodes": 40})
    measured = worker.Pace()
    measured.record(0, study.resolved[0], 1, seconds)
    start %= study.runs
    assert worker.claim_size(study, measured, 1, start) >= 1
    chunk = range(start, min(start + worker.claim_size(study, measured, 1, start), study.runs))
    split = [(setting, seed) for setting, seeds in study.split(chunk) for seed in seeds]
    assert split == [divmod(run, seeds) for run in chunk]


@pytest.mark.parametrize("with_store", [False, True])
def test_a_sweep_interrupted_while_it_plans_has_what_is_stored(tmp_path, monkeypatch, with_store):
    path = tmp_path / "study.db"
    if with_store:
        qtab.sweep(CAR, GRID, store=path, **SMALL)

    def interrupt(*_: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(studies, "settings_of", interrupt)
    with pytest.raises(KeyboardInterrupt) as caught:
        qtab.sweep(CAR, GRID, store=path if with_store else None, **SMALL)
    partial = run_of(caught.value)
    assert len(partial) == (30 if with_store else 0)
    assert repr(partial).startswith("<Sweep of MountainCar-v0: ")
    assert partial.failed == 0
    assert partial.ranking() == list(range(len(partial.settings))) or with_store
