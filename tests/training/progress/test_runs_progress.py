"""``train_many`` reports the finished runs, can be stopped by a callback, and trains the same runs meanwhile."""

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.callbacks import EvaluateEvery
from qtab.training import runs_progress
from support.parity import run_of
from support.repository import ROOT

CAR = "MountainCar-v0"
SHORT: dict[str, Any] = {"episodes": 6, "max_episode_steps": 30}


def assert_same_runs(one: qtab.Runs, other: qtab.Runs) -> None:
    assert one.seeds == other.seeds
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    assert one.episode_lengths.tobytes() == other.episode_lengths.tobytes()
    assert one.terminated.tobytes() == other.terminated.tobytes()
    assert one.tables is not None
    assert other.tables is not None
    assert one.tables.tobytes() == other.tables.tobytes()


@given(
    seeds=st.lists(st.integers(0, 2**64), min_size=1, max_size=40, unique=True),
    threads=st.integers(1, 3),
    every=st.none() | st.integers(1, 50),
)
@settings(max_examples=settings().max_examples // 3)
def test_a_callback_sees_finished_runs_and_does_not_change_them(seeds, threads, every):
    seen: list[qtab.RunsProgress] = []
    chosen: dict[str, Any] = {**SHORT, "threads": threads, "tables": True}
    runs = qtab.train_many(CAR, seeds, callback=seen.append, callback_every=every, **chosen)
    assert_same_runs(runs, qtab.train_many(CAR, seeds, **chosen))
    counts = [progress.runs for progress in seen]
    assert counts == sorted(set(counts))
    assert counts[-1] == len(seeds)
    if every is not None:
        assert counts == sorted({*range(every, len(seeds) + 1, every), len(seeds)})
    for progress in seen:  # read after the end, when later runs are finished, too
        assert progress.total == len(seeds)
        assert progress.seeds == tuple(seeds[: progress.runs])
        assert progress.returns.tobytes() == runs.episode_returns[: progress.runs].tobytes()
        assert progress.lengths.tobytes() == runs.episode_lengths[: progress.runs].tobytes()
        assert progress.seconds <= runs.seconds
        assert_same_runs(progress.finished, runs[: progress.runs])
        assert progress.finished.completed is (progress.runs == len(seeds))


@pytest.mark.parametrize("no", [False, np.False_, 0])
def test_returning_false_stops_the_training_and_keeps_the_finished_runs(no):
    runs = qtab.train_many(
        CAR,
        20,
        tables=True,
        callback=[lambda p: None, lambda p: no if p.runs == 6 else True],
        callback_every=3,
        **SHORT,
    )
    assert runs.completed is False
    assert runs.seeds == tuple(range(6))
    assert_same_runs(runs, qtab.train_many(CAR, 6, tables=True, **SHORT))


def test_false_after_the_last_run_is_too_late_to_stop():
    assert qtab.train_many(CAR, 4, callback=lambda p: p.runs < 4, callback_every=2, **SHORT).completed


@pytest.mark.parametrize("raised", [RuntimeError("enough"), KeyboardInterrupt()])
def test_an_exception_in_a_callback_carries_the_finished_runs(raised):
    def fail(progress):
        raise raised

    with pytest.raises(type(raised)) as caught:
        qtab.train_many(CAR, 20, callback=fail, callback_every=5, **SHORT)
    assert caught.value is raised
    assert run_of(raised).seeds == tuple(range(5))


def test_a_run_that_fails_in_a_later_part_is_named_and_keeps_the_finished_ones():
    steep: dict[str, Any] = {"discretizer": "tiles", "algorithm": "sarsa_lambda", "traces": "accumulating"}
    steep |= {"trace_decay": 1.0, "learning_rate": 1.5, "discount": 1.0, "epsilon": 0.8, "min_epsilon": 0.8}
    seen: list[int] = []
    with pytest.raises(OverflowError) as caught:
        qtab.train_many(CAR, [1, 0, 3], episodes=4, callback=lambda p: seen.append(p.runs), callback_every=1, **steep)
    assert seen == [1]
    assert "seed 0" in getattr(caught.value, "__notes__", ["seed 0"])[0]
    assert run_of(caught.value).seeds == (1,)


@pytest.mark.slow
def test_runs_in_processes_are_reported_too():
    seen: list[int] = []

    def stop(progress: qtab.RunsProgress) -> bool:
        seen.append(progress.runs)
        return progress.runs < 4 and progress.returns.shape == (progress.runs, 6)

    runs = qtab.train_many(CAR, 6, backend="gymnasium", threads=2, callback=stop, **SHORT)
    assert seen[-1] >= 4
    assert seen == sorted(set(seen))
    assert runs.completed is (seen[-1] == 6)
    for seed, returns in zip(runs.seeds, runs.episode_returns, strict=True):
        assert returns.tobytes() == qtab.train(CAR, seed=seed, **SHORT).episode_returns.tobytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"callback": 3}, r"^callback must be callable, got 3$"),
        ({"callback": [print, None]}, r"^callback\[1\] must be callable, got None$"),
        (
            {"callback": EvaluateEvery()},
            r"^callback must take a RunsProgress; EvaluateEvery works only with qtab.train",
        ),
        ({"callback": EvaluateEvery}, r"^callback must be an instance, as in EvaluateEvery"),
        ({"callback_every": 0}, r"^callback_every must be an integer of at least 1, got 0$"),
        ({"callback_every": 1.5}, r"^callback_every must be an integer of at least 1, got 1\.5$"),
        ({"progress": "yes"}, r"^progress must be True, False or None, got 'yes'$"),
    ],
)
def test_wrong_arguments_are_refused_by_name(arguments, message):
    with pytest.raises((TypeError, ValueError), match=message):
        qtab.train_many(CAR, 4, **SHORT, **arguments)


def test_a_bar_counts_the_runs(capsys):
    runs = qtab.train_many(CAR, 40, progress=True, tables=True, **SHORT)
    assert_same_runs(runs, qtab.train_many(CAR, 40, tables=True, **SHORT))
    shown = capsys.readouterr().err
    assert "40/40" in shown or "| 0/40" in shown
    assert "runs" in shown


def test_a_thread_trains_as_many_runs_at_once_as_rust_has_lanes() -> None:
    text = (ROOT / "rust" / "core" / "src" / "simd" / "mod.rs").read_text(encoding="utf-8")
    assert re.findall(r"^pub const LANES: usize = (\d+);$", text, re.MULTILINE) == [str(runs_progress.LANES)]
