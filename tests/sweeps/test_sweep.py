"""Sweeps give the same tidy table, whether interrupted or not."""

import multiprocessing
import signal
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from typing import Any

import pytest

import qtab
from support.parity import run_of
from support.processes.posix import posix_only
from support.sweeps import CAR, GRID, SMALL, assert_equal


def test_each_row_holds_the_results_of_its_single_run():
    study = qtab.sweep(CAR, GRID, seeds=3, episodes=250, block=50)
    assert len(study) == 3 * 2 * 3
    names = ["setting", "learning_rate", "epsilon", "seed", "episodes", "steps"]
    assert list(study.columns)[:6] == names
    for row in (0, 7, 17):
        config: dict[str, Any] = {name: float(study.columns[name][row]) for name in GRID}
        run = qtab.train(CAR, seed=int(study.columns["seed"][row]), episodes=250, **config)
        assert study.columns["mean_return"][row] == run.episode_returns.mean()
        assert study.columns["final_return"][row] == run.episode_returns[-100:].mean()
        assert study.columns["steps"][row] == run.episode_lengths.sum()
        setting = int(study.columns["setting"][row])
        curve = study.curves(setting)[study.columns["seed"][row]]
        assert curve.tolist() == run.mean_returns(50).tolist()
    assert study.failed == 0


def test_every_setting_has_the_same_seeds():
    study = qtab.sweep(CAR, GRID, seeds=[7, 3], episodes=5)
    for setting in range(6):
        assert study.values("seed", setting).tolist() == [7, 3]


def test_the_table_converts_to_pandas_and_arrow():
    study = qtab.sweep(CAR, {"scale": [(5, 50), (10, 100)], "terminal_update": ["assign", "target"]}, **SMALL)
    frame = study.to_pandas()
    assert frame.shape == (20, 11)
    assert frame.groupby(["scale", "terminal_update"])["final_return"].count().tolist() == [5, 5, 5, 5]
    table = study.to_arrow()
    assert table.column_names == list(frame.columns)
    assert table["mean_return"].to_pylist() == frame["mean_return"].tolist()
    assert table["error"].null_count == 20


@pytest.mark.parametrize("threads", [1, 3])
def test_threads_and_stores_do_not_change_the_results(tmp_path, small_chunks, threads):
    study = qtab.sweep(CAR, GRID, threads=threads, store=tmp_path / "study.db", **SMALL)
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))


@pytest.mark.parametrize("make", [ThreadPoolExecutor, pytest.param(ProcessPoolExecutor, marks=pytest.mark.slow)])
def test_executors_do_not_change_the_results(small_chunks, make):
    extra = {"mp_context": multiprocessing.get_context("spawn")} if make is ProcessPoolExecutor else {}
    with make(2, **extra) as executor:
        study = qtab.sweep(CAR, GRID, executor=executor, **SMALL)
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))


def test_progress_is_reported_during_the_sweep(small_chunks):
    seen: list[qtab.SweepProgress] = []
    qtab.sweep(CAR, GRID, callback=seen.append, **SMALL)
    assert len(seen) >= 10
    assert [progress.runs for progress in seen] == sorted({progress.runs for progress in seen})
    assert (seen[-1].runs, seen[-1].total, seen[-1].new) == (30, 30, 30)


def test_a_finished_store_is_read_without_training(tmp_path, small_chunks):
    path = tmp_path / "study.db"
    first = qtab.sweep(CAR, GRID, store=path, **SMALL)
    seen: list[qtab.SweepProgress] = []
    assert_equal(qtab.sweep(CAR, GRID, store=path, callback=seen.append, **SMALL), first)
    assert seen == []


SCRIPT = """
import sys, time, qtab
from qtab.sweeps import worker
worker.MAX_CHUNK_RUNS = 3
def report(progress):
    print(progress.runs, progress.new, flush=True)
    if progress.runs >= {last}:
        time.sleep(600)
qtab.sweep("MountainCar-v0", {grid}, seeds={seeds}, episodes=40, store=sys.argv[1], callback=report)
"""


def start(path, seeds, last=10**9):
    """A sweep in a process, which prints a line after each chunk, and waits to be killed after ``last`` runs."""
    script = SCRIPT.format(grid=GRID, seeds=seeds, last=last)
    return subprocess.Popen([sys.executable, "-c", script, str(path)], stdout=subprocess.PIPE, text=True)


@posix_only
@pytest.mark.slow
@pytest.mark.parametrize("chunks", [1, 4])
def test_a_killed_sweep_resumes(tmp_path, small_chunks, chunks):
    path = tmp_path / "study.db"
    many: dict[str, Any] = {"seeds": 120, "episodes": 40}
    process = start(path, seeds=120, last=600)  # it is not done before it is killed
    for _ in range(chunks):
        process.stdout.readline()
    process.kill()
    rest = process.communicate()[0].split()
    assert process.returncode == -signal.SIGKILL
    seen: list[qtab.SweepProgress] = []
    study = qtab.sweep(CAR, GRID, store=path, callback=seen.append, **many)
    found = seen[0].runs - seen[0].new
    assert found >= chunks
    assert len(rest) == 0 or found >= int(rest[-2])
    assert seen[-1].new == 720 - found
    assert_equal(study, qtab.sweep(CAR, GRID, **many))


def test_ctrl_c_keeps_the_finished_runs_and_releases_the_others(tmp_path, small_chunks):
    path = tmp_path / "study.db"

    def interrupt(progress):
        if progress.new > 10:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt) as caught:
        qtab.sweep(CAR, GRID, store=path, callback=interrupt, **SMALL)
    partial = run_of(caught.value)
    assert 10 < len(partial) < 30
    whole = qtab.sweep(CAR, GRID, store=path, **SMALL)
    assert partial.columns["steps"].tolist() == whole.columns["steps"][: len(partial)].tolist()
    assert_equal(whole, qtab.sweep(CAR, GRID, **SMALL))


@pytest.mark.slow
def test_two_processes_share_a_store(tmp_path, small_chunks):
    path = tmp_path / "study.db"
    both = [start(path, seeds=60) for _ in range(2)]
    new = []
    for process in both:
        lines = process.communicate(timeout=600)[0].splitlines()
        assert process.returncode == 0
        new.append(len(lines))
    assert sum(new) >= 120
    assert_equal(qtab.sweep(CAR, GRID, store=path, seeds=60, episodes=40), qtab.sweep(CAR, GRID, seeds=60, episodes=40))


def test_the_names_of_settings_may_come_in_any_order():
    points: list[dict[str, Any]] = [{"learning_rate": 0.1, "epsilon": 0.3}, {"epsilon": 0.8, "learning_rate": 0.2}]
    table = qtab.sweep(CAR, points, **SMALL)
    assert [list(setting) for setting in table.settings] == [["learning_rate", "epsilon"]] * 2
    assert_equal(table, qtab.sweep(CAR, [points[0], {"learning_rate": 0.2, "epsilon": 0.8}], **SMALL))
    with pytest.raises(ValueError, match="the same one twice"):
        qtab.sweep(CAR, [points[0], dict(reversed(points[0].items()))], **SMALL)
