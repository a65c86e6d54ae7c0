"""Stores, disks, runs and workers that fail, and bad input."""

import contextlib
import sqlite3
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.sweeps import store as stores
from support.environments import make_brittle
from support.sweeps import CAR, GRID, SMALL, assert_equal


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("UPDATE meta SET value = '99' WHERE name = 'version'", "format version '99', but this qtab reads 2 and 3"),
        ("UPDATE meta SET value = '{}' WHERE name = 'study'", "damaged.* no configs, settings, seeds and block"),
        ("UPDATE meta SET value = 'x' WHERE name = 'format'", "is not a sweep store"),
        ("DROP TABLE meta", "is not a sweep store"),
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


@pytest.mark.parametrize("change", [{"seeds": range(1, 6)}, {"episodes": 41}, {"block": 7}, {"discount": 0.5}])
def test_a_store_of_another_sweep_is_refused(tmp_path, change):
    path = tmp_path / "study.db"
    qtab.sweep(CAR, GRID, store=path, **SMALL)
    with pytest.raises(qtab.StoreError, match="belongs to another sweep"):
        qtab.sweep(CAR, GRID, store=path, **{**SMALL, **change})


def test_a_damaged_store_is_refused(tmp_path):
    path = tmp_path / "study.db"
    path.write_bytes(b"SQLite is what this is not" * 100)
    with pytest.raises(qtab.StoreError, match="damaged, or not a sweep store"):
        qtab.sweep(CAR, GRID, store=path, **SMALL)
    path.unlink()
    qtab.sweep(CAR, GRID, store=path, **SMALL)
    with path.open("r+b") as file:
        file.seek(4096 * 2)
        file.write(b"\xff" * 4096)
    with pytest.raises(qtab.StoreError, match="damaged"):
        qtab.sweep(CAR, GRID, store=path, **SMALL)


def test_a_store_that_cannot_be_written_raises_an_os_error(tmp_path):
    with pytest.raises(OSError, match="unable to open"):
        qtab.sweep(CAR, GRID, store=tmp_path / "no" / "study.db", **SMALL)


@pytest.mark.slow
def test_a_full_disk_raises_an_error_and_the_sweep_can_be_resumed(tmp_path, small_chunks, monkeypatch):
    path = tmp_path / "study.db"
    connect = stores.connect  # type: ignore[attr-defined]

    def tight(path, *mode):
        connection = connect(path, *mode)
        pages = connection.execute("PRAGMA page_count").fetchone()[0]
        connection.execute(f"PRAGMA max_page_count = {max(pages, 12)}")
        return connection

    many: dict[str, Any] = {"seeds": 250, "episodes": 40}
    monkeypatch.setattr(stores, "connect", tight)
    with pytest.raises(OSError, match="full"):
        qtab.sweep(CAR, GRID, store=path, **many)
    monkeypatch.setattr(stores, "connect", connect)
    seen: list[qtab.SweepProgress] = []
    study = qtab.sweep(CAR, GRID, store=path, callback=seen.append, **many)
    assert seen[-1].new < 1500
    assert_equal(study, qtab.sweep(CAR, GRID, **many))


def test_a_failing_run_is_recorded_and_the_others_continue(tmp_path):
    grid: dict[str, Any] = {"learning_rate": [0.1, 0.5]}
    study = qtab.sweep(make_brittle, grid, seeds=3, episodes=2, scale=(10, 100), threads=2, store=tmp_path / "s.db")
    assert study.failed == 2
    assert study.columns["error"].tolist() == [None, None, "RuntimeError: out of order"] * 2
    assert np.isnan(study.columns["mean_return"][[2, 5]]).all()
    assert study.values("seed", 1).tolist() == [0, 1]
    single = qtab.train(make_brittle(), seed=1, learning_rate=0.5, episodes=2, scale=(10, 100))
    assert study.values("mean_return", 1)[1] == single.episode_returns.mean()


def test_a_run_that_diverges_is_recorded():
    steep: dict[str, Any] = {
        "discretizer": "tiles",
        "algorithm": "sarsa_lambda",
        "traces": "accumulating",
        "trace_decay": 1.0,
    }
    steep |= {"discount": 1.0, "epsilon": 0.8, "min_epsilon": 0.8}
    study = qtab.sweep(CAR, {"learning_rate": [0.1, 1.5]}, seeds=3, episodes=4, **steep)
    said = study.columns["error"].tolist()
    assert said[:3] == [None] * 3
    assert [text is None for text in said[3:]] == [False, True, True]
    assert said[3].startswith("OverflowError: the action values overflowed")


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
        (
            {"grid": [{"epsilon": 0.1}, {"discount": 0.1}]},
            ValueError,
            r"every setting in grid must have the names of the first, but grid\[1\] lacks 'epsilon' and also has 'disc",
        ),
        ({"grid": [{"epsilon": 0.1, "discount": 0.1}, {"epsilon": 0.1}]}, ValueError, r"grid\[1\] lacks 'discount'$"),
        ({"grid": [{"epsilon": 0.1}, {"epsilon": 0.1, "seed": 0}]}, ValueError, r"grid\[1\] also has 'seed'$"),
        ({"grid": [{"epsilon": 0.1}, {"epsilon": 0.1}]}, ValueError, "the same one twice"),
        ({"grid": {"epsilom": [0.1]}}, TypeError, "unknown setting 'epsilom'"),
        ({"grid": {"epsilon": ["x"]}}, TypeError, "epsilon must be a number"),
        ({"grid": {"epsilon": [0.1, 3]}}, ValueError, "epsilon must lie in"),
        ({"grid": {"seed": [1, 2]}}, TypeError, "seed cannot be a setting of a sweep"),
        ({"epsilon": 0.3}, TypeError, "epsilon must be either in the grid or shared"),
        ({"learning_rat": 0.3}, TypeError, "unknown setting 'learning_rat'"),
        ({"seeds": 0}, ValueError, "seeds must be"),
        ({"seeds": [1, 1]}, ValueError, "seeds must differ"),
        ({"threads": -1}, ValueError, "threads must be"),
        ({"executor": 3}, TypeError, "executor must have a method submit"),
        ({"block": 0}, ValueError, "block must be"),
        ({"block": 10**30}, ValueError, r"block must be less than 2\*\*63"),
        ({"callback": 3}, TypeError, "callback must be a function of the progress or None, got 3"),
        ({"seeds": 10**9}, MemoryError, "the results of 6,000,000,000 runs would take"),
        ({"seeds": 10**12}, MemoryError, "the results of 6,000,000,000,000 runs would take"),
        ({"seeds": range(10**30)}, MemoryError, "runs would take"),
        (
            {"grid": {"epsilon": range(10**9), "discount": range(10**9)}},
            MemoryError,
            "1,000,000,000,000,000,000 settings",
        ),
        (
            {"episodes": 10**11},
            MemoryError,
            "runs of 100,000,000,000 episodes would take 3.09 TiB, more than half",
        ),
        ({"memory_limit": 1000}, MemoryError, "more than memory_limit=1000"),
        ({"memory_limit": "much"}, TypeError, "memory_limit must be"),
        ({"env": gym.make(CAR)}, TypeError, "env must be an id"),
    ],
)
def test_bad_input_is_refused_before_anything_starts(tmp_path, arguments, error, message):
    path = tmp_path / "study.db"
    with pytest.raises(error, match=message):
        qtab.sweep(**{"env": CAR, "grid": GRID, "store": path, **SMALL, **arguments})
    assert not path.exists()
