"""Sweeps: a tidy table, whatever was killed on the way to it."""

import contextlib
import multiprocessing
import os
import signal
import sqlite3
import subprocess
import sys
import textwrap
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab import designs
from qtab.sweeping import store as stores
from qtab.sweeping import study as studies

CAR = "MountainCar-v0"
GRID = {"learning_rate": [0.1, 0.2, 0.4], "epsilon": [0.3, 0.8]}
SMALL = {"seeds": 5, "episodes": 40}


@pytest.fixture
def small_pieces(monkeypatch):
    """Some three runs a piece."""
    monkeypatch.setattr(studies, "PIECE_STEPS", 2 * 40 * 200 + 1)
    monkeypatch.setattr(studies, "PYTHON_PIECE_STEPS", 1)


def assert_equal(one, other):
    assert list(one.columns) == list(other.columns)
    for name, column in one.columns.items():
        assert column.dtype == other.columns[name].dtype
        np.testing.assert_array_equal(column, other.columns[name], strict=True)
    assert list(one._curves) == list(other._curves)


def test_a_row_a_run_with_the_lone_runs_numbers():
    study = qtab.sweep(CAR, GRID, seeds=3, episodes=250, block=50)
    assert len(study) == 3 * 2 * 3
    names = ["setting", "learning_rate", "epsilon", "seed", "episodes", "steps"]
    assert list(study.columns)[:6] == names
    for row in (0, 7, 17):
        config = {name: float(study.columns[name][row]) for name in GRID}
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


def test_the_table_for_pandas_and_arrow():
    study = qtab.sweep(CAR, {"scale": [(5, 50), (10, 100)], "terminal_update": ["assign", "target"]}, **SMALL)
    frame = study.to_pandas()
    assert frame.shape == (20, 11)
    assert frame.groupby(["scale", "terminal_update"])["final_return"].count().tolist() == [5, 5, 5, 5]
    table = study.to_arrow()
    assert table.column_names == list(frame.columns)
    assert table["mean_return"].to_pylist() == frame["mean_return"].tolist()
    assert table["error"].null_count == 20


@pytest.mark.parametrize("threads", [1, 3])
def test_threads_and_stores_change_nothing(tmp_path, small_pieces, threads):
    study = qtab.sweep(CAR, GRID, threads=threads, store=tmp_path / "study.db", **SMALL)
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))


@pytest.mark.parametrize("make", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_any_executor_changes_nothing(small_pieces, make):
    extra = {"mp_context": multiprocessing.get_context("spawn")} if make is ProcessPoolExecutor else {}
    with make(2, **extra) as executor:
        study = qtab.sweep(CAR, GRID, executor=executor, **SMALL)
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))


def test_progress_comes_as_it_happens(small_pieces):
    seen = []
    qtab.sweep(CAR, GRID, callback=seen.append, **SMALL)
    assert len(seen) >= 10
    assert [progress.runs for progress in seen] == sorted({progress.runs for progress in seen})
    assert (seen[-1].runs, seen[-1].total, seen[-1].new) == (30, 30, 30)


def test_a_finished_store_is_read_and_nothing_trained_again(tmp_path, small_pieces):
    path = tmp_path / "study.db"
    first = qtab.sweep(CAR, GRID, store=path, **SMALL)
    seen = []
    assert_equal(qtab.sweep(CAR, GRID, store=path, callback=seen.append, **SMALL), first)
    assert seen == []


SCRIPT = """
import sys, qtab
from qtab.sweeping import study
study.PIECE_STEPS = 2 * 40 * 200 + 1
qtab.sweep("MountainCar-v0", {grid}, seeds={seeds}, episodes=40, store=sys.argv[1],
           callback=lambda progress: print(progress.runs, progress.new, flush=True))
"""


def start(path, seeds=5):
    script = textwrap.dedent(SCRIPT.format(grid=GRID, seeds=seeds))
    return subprocess.Popen([sys.executable, "-c", script, str(path)], stdout=subprocess.PIPE, text=True)


@pytest.mark.parametrize("pieces", [1, 4])
def test_killed_at_any_moment_it_goes_on(tmp_path, small_pieces, pieces):
    path = tmp_path / "study.db"
    many = {"seeds": 200, "episodes": 40}
    process = start(path, seeds=200)
    for _ in range(pieces):
        process.stdout.readline()
    process.kill()
    rest = process.communicate()[0].split()
    assert process.returncode == -signal.SIGKILL, "it was done before it was killed"
    seen = []
    study = qtab.sweep(CAR, GRID, store=path, callback=seen.append, **many)
    found = seen[0].runs - seen[0].new
    assert found >= pieces
    assert len(rest) == 0 or found >= int(rest[-2])
    assert seen[-1].new == 1200 - found
    assert_equal(study, qtab.sweep(CAR, GRID, **many))


def test_ctrl_c_keeps_the_finished_runs_and_lets_go_of_the_others(tmp_path, small_pieces):
    path = tmp_path / "study.db"

    def interrupt(progress):
        if progress.new > 10:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt) as caught:
        qtab.sweep(CAR, GRID, store=path, callback=interrupt, **SMALL)
    partial = caught.value.run
    assert 10 < len(partial) < 30
    whole = qtab.sweep(CAR, GRID, store=path, **SMALL)
    assert partial.columns["steps"].tolist() == whole.columns["steps"][: len(partial)].tolist()
    assert_equal(whole, qtab.sweep(CAR, GRID, **SMALL))


def test_two_processes_share_a_store(tmp_path, small_pieces):
    path = tmp_path / "study.db"
    both = [start(path, seeds=150) for _ in range(2)]
    new = []
    for process in both:
        lines = process.communicate(timeout=60)[0].splitlines()
        assert process.returncode == 0
        new.append(len(lines))
    pieces = studies.study(CAR, GRID, 150, 100, {"episodes": 40}).pieces
    assert sum(new) == len(pieces)
    assert_equal(
        qtab.sweep(CAR, GRID, store=path, seeds=150, episodes=40), qtab.sweep(CAR, GRID, seeds=150, episodes=40)
    )


def test_an_expired_claim_is_taken_over_and_a_late_result_is_not_entered_twice(tmp_path, small_pieces, monkeypatch):
    path = tmp_path / "study.db"
    planned = studies.study(CAR, GRID, 5, 100, {"episodes": 40})
    slow = stores.Store(path, planned)
    number = slow.claim()
    monkeypatch.setattr(stores, "EXPIRY", -1.0)
    study = qtab.sweep(CAR, GRID, store=path, **SMALL)
    monkeypatch.undo()
    piece = planned.pieces[number]
    rows = [stores.Row(0, None, b"", "late")] * (piece.stop - piece.start)
    assert slow.enter(piece, rows) is False
    slow.close()
    assert study.failed == 0
    assert len(study) == 30


def test_pieces_depend_on_the_grid_alone():
    one = studies.study(CAR, GRID, 1000, 100, {"episodes": 5000})
    assert one.pieces == studies.study(CAR, GRID, 1000, 100, {"episodes": 5000}).pieces
    assert one.pieces[0].start == 0
    assert one.pieces[-1].stop == 6000
    assert all(piece.stop == after.start for piece, after in zip(one.pieces, one.pieces[1:], strict=False))
    assert 50 < one.pieces[0].stop < 100


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("UPDATE meta SET value = '99' WHERE name = 'version'", "version '99' of the format, this qtab has 1"),
        ("UPDATE meta SET value = '{}' WHERE name = 'study'", "belongs to another sweep"),
        ("UPDATE meta SET value = 'x' WHERE name = 'format'", "is no store of a sweep"),
        ("DROP TABLE meta", "is no store of a sweep"),
    ],
)
def test_a_store_of_another_kind_is_refused(tmp_path, change, message):
    path = tmp_path / "study.db"
    qtab.sweep(CAR, GRID, store=path, **SMALL)
    with contextlib.closing(sqlite3.connect(path)) as connection:
        connection.execute(change)
        connection.commit()
    with pytest.raises(qtab.StoreError, match=message):
        qtab.sweep(CAR, GRID, store=path, **SMALL)


@pytest.mark.parametrize("change", [{"seeds": 6}, {"episodes": 41}, {"block": 7}, {"discount": 0.5}])
def test_a_store_of_another_sweep_is_refused(tmp_path, change):
    path = tmp_path / "study.db"
    qtab.sweep(CAR, GRID, store=path, **SMALL)
    with pytest.raises(qtab.StoreError, match="belongs to another sweep"):
        qtab.sweep(CAR, GRID, store=path, **{**SMALL, **change})


def test_a_damaged_store_is_refused(tmp_path):
    path = tmp_path / "study.db"
    path.write_bytes(b"SQLite is what this is not" * 100)
    with pytest.raises(qtab.StoreError, match="damaged or no store"):
        qtab.sweep(CAR, GRID, store=path, **SMALL)
    path.unlink()
    qtab.sweep(CAR, GRID, store=path, **SMALL)
    with path.open("r+b") as file:
        file.seek(4096 * 2)
        file.write(b"\xff" * 4096)
    with pytest.raises(qtab.StoreError, match="damaged"):
        qtab.sweep(CAR, GRID, store=path, **SMALL)


def test_a_store_that_cannot_be_written_is_an_error_of_the_system(tmp_path):
    with pytest.raises(OSError, match="unable to open"):
        qtab.sweep(CAR, GRID, store=tmp_path / "no" / "study.db", **SMALL)


def test_a_full_disk_is_an_error_and_breaks_nothing(tmp_path, small_pieces, monkeypatch):
    path = tmp_path / "study.db"
    connect = stores._connect

    def tight(path):
        connection = connect(path)
        pages = connection.execute("PRAGMA page_count").fetchone()[0]
        connection.execute(f"PRAGMA max_page_count = {max(pages, 12)}")
        return connection

    many = {"seeds": 200, "episodes": 40}
    monkeypatch.setattr(stores, "_connect", tight)
    with pytest.raises(OSError, match="full"):
        qtab.sweep(CAR, GRID, store=path, **many)
    monkeypatch.setattr(stores, "_connect", connect)
    seen = []
    study = qtab.sweep(CAR, GRID, store=path, callback=seen.append, **many)
    assert seen[-1].new < 1200
    assert_equal(study, qtab.sweep(CAR, GRID, **many))


class Brittle(gym.Wrapper):
    """Fails in its second episode when its first came from seed 2."""

    def reset(self, *, seed=None, options=None):
        if seed is None and self.bad:
            raise RuntimeError("out of order")
        self.bad = seed == 2
        return self.env.reset(seed=seed, options=options)


def make_brittle():
    return Brittle(gym.make(CAR))


def test_a_run_that_fails_is_recorded_and_the_others_go_on(tmp_path):
    grid = {"learning_rate": [0.1, 0.5]}
    study = qtab.sweep(make_brittle, grid, seeds=3, episodes=2, scale=(10, 100), threads=2, store=tmp_path / "s.db")
    assert study.failed == 2
    assert study.columns["error"].tolist() == [None, None, "RuntimeError: out of order"] * 2
    assert np.isnan(study.columns["mean_return"][[2, 5]]).all()
    assert study.values("seed", 1).tolist() == [0, 1]
    lone = qtab.train(make_brittle(), seed=1, learning_rate=0.5, episodes=2, scale=(10, 100))
    assert study.values("mean_return", 1)[1] == lone.episode_returns.mean()


def test_a_run_that_diverges_is_recorded():
    steep = {"discretizer": "tiles", "algorithm": "sarsa_lambda", "traces": "accumulating", "trace_decay": 1.0}
    steep |= {"discount": 1.0, "epsilon": 0.8, "min_epsilon": 0.8}
    study = qtab.sweep(CAR, {"learning_rate": [0.1, 1.5]}, seeds=3, episodes=4, **steep)
    said = study.columns["error"].tolist()
    assert said[:3] == [None] * 3
    assert [text is None for text in said[3:]] == [False, True, True]
    assert said[3].startswith("OverflowError: the action values overflowed")


@pytest.mark.filterwarnings("ignore")  # distributed's own
def test_dask_with_a_worker_killed_gives_the_same_table(tmp_path, small_pieces):
    from distributed import Client, LocalCluster

    many = {"seeds": 40, "episodes": 40}
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50)
    with cluster, Client(cluster) as client:
        workers = list(client.run(os.getpid).values())
        killed = []

        def kill(progress):
            if not killed:
                os.kill(workers[0], signal.SIGKILL)
                killed.append(progress.runs)

        study = qtab.sweep(CAR, GRID, executor=client.get_executor(), callback=kill, store=tmp_path / "s.db", **many)
    assert 0 < killed[0] < 240
    assert_equal(study, qtab.sweep(CAR, GRID, **many))


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"grid": {}}, ValueError, "grid must name"),
        ({"grid": []}, ValueError, "grid must hold at least one setting"),
        ({"grid": {"epsilon": []}}, ValueError, r"grid\['epsilon'\] must hold at least one value"),
        ({"grid": {"epsilon": [0.1, 0.1]}}, ValueError, r"grid\['epsilon'\] must hold different values"),
        ({"grid": {"epsilon": 0.1}}, TypeError, r"grid\['epsilon'\] must be a list of values"),
        ({"grid": {"epsilon": "abc"}}, TypeError, r"grid\['epsilon'\] must be a list of values"),
        ({"grid": 3}, TypeError, "grid must map names"),
        ({"grid": [3]}, TypeError, "grid must hold mappings"),
        ({"grid": [{"epsilon": 0.1}, {"discount": 0.1}]}, ValueError, "the same names"),
        ({"grid": [{"epsilon": 0.1}, {"epsilon": 0.1}]}, ValueError, "one twice"),
        ({"grid": {"epsilom": [0.1]}}, TypeError, "'epsilom' is no setting"),
        ({"grid": {"epsilon": ["x"]}}, TypeError, "epsilon must be a number"),
        ({"grid": {"epsilon": [0.1, 3]}}, ValueError, "epsilon must lie in"),
        ({"grid": {"seed": [1, 2]}}, TypeError, "seed is no part of a grid"),
        ({"epsilon": 0.3}, TypeError, "epsilon is both in the grid and fixed"),
        ({"learning_rat": 0.3}, TypeError, "'learning_rat' is no setting"),
        ({"seeds": 0}, ValueError, "seeds must be"),
        ({"seeds": [1, 1]}, ValueError, "seeds must differ"),
        ({"threads": -1}, ValueError, "threads must be"),
        ({"executor": 3}, TypeError, "executor must have the method submit"),
        ({"block": 0}, ValueError, "block must be"),
        ({"env": gym.make(CAR)}, TypeError, "env must be an id"),
    ],
)
def test_bad_input_is_refused_before_anything_starts(tmp_path, arguments, error, message):
    path = tmp_path / "study.db"
    with pytest.raises(error, match=message):
        qtab.sweep(**{"env": CAR, "grid": GRID, "store": path, **SMALL, **arguments})
    assert not path.exists()


def test_a_design_is_a_grid_too():
    space = {"learning_rate": (0.01, 1.0, "log"), "discount": (0.8, 1.0), "episodes": range(3, 9)}
    for design in (designs.random(space, 8, seed=1), designs.sobol(space, 8, seed=1)):
        study = qtab.sweep(CAR, design, seeds=2)
        assert len(study) == 16
        assert study.columns["learning_rate"][::2].tolist() == [setting["learning_rate"] for setting in design]


def test_sobols_points_are_spread_evenly():
    points = designs.sobol({"a": (0.0, 8.0), "b": ["x", "y"]}, 8, seed=3)
    assert sorted(int(point["a"]) for point in points) == list(range(8))
    assert sorted(point["b"] for point in points) == ["x"] * 4 + ["y"] * 4
    assert designs.sobol({"a": (0.0, 8.0)}, 8, seed=3) == designs.sobol({"a": (0.0, 8.0)}, 8, seed=3)
    with pytest.raises(ValueError, match="power of two"):
        designs.sobol({"a": (0.0, 8.0)}, 7)


@settings(max_examples=50, deadline=None)
@given(low=st.floats(1e-6, 1.0), span=st.floats(0.01, 100), seed=st.integers(0, 2**32))
def test_points_lie_in_their_space(low, span, seed):
    space = {"a": (low, low + span), "b": (low, low + span, "log"), "c": [1, 2, 3]}
    for point in designs.random(space, 5, seed=seed):
        assert low <= point["a"] <= low + span
        assert low * (1 - 1e-12) <= point["b"] <= (low + span) * (1 + 1e-12)
        assert point["c"] in (1, 2, 3)


@pytest.mark.parametrize("axis", [(2, 1), (0, 1, "log"), (1, 2, "lin"), 3, [], "ab", (1,)])
def test_a_bad_axis_is_refused_by_name(axis):
    with pytest.raises((ValueError, TypeError), match=r"space\['a'\] must"):
        designs.random({"a": axis}, 3)
