"""Results as data frames: integers stay integers, and the advice without pandas helps."""

import sys
from typing import Any

import numpy as np
import pytest

import qtab
from qtab._utils.data_frames import arrow_table, cell_column

GRID: dict[str, list[Any]] = {"learning_rate": [0.1, 2.0]}
DIVERGES: dict[str, Any] = {
    "preset": "solved",
    "algorithm": "sarsa_lambda",
    "traces": "accumulating",
    "trace_decay": 1.0,
    "discount": 1.0,
    "tilings": 32,
}


@pytest.fixture(scope="module")
def run() -> qtab.Run:
    return qtab.train("FrozenLake-v1", seed=0, episodes=20)


def test_a_run_has_a_row_for_each_episode(run):
    frame = run.to_pandas()
    assert list(frame.columns) == ["episode", "return", "length", "terminated"]
    assert [str(dtype) for dtype in frame.dtypes] == ["int64", "float64", "int64", "bool"]
    assert frame["return"].tolist() == run.episode_returns.tolist()
    assert frame["episode"].tolist() == list(range(20))


def test_runs_have_a_row_for_each_run():
    runs = qtab.train_many("FrozenLake-v1", seeds=3, episodes=20)
    frame = runs.to_pandas()
    assert {name: column.tolist() for name, column in runs.summaries().items()} == frame.to_dict("list")
    assert str(frame["steps"].dtype) == str(frame["episodes"].dtype) == str(frame["seed"].dtype) == "int64"


def test_an_evaluation_has_a_row_for_each_episode(run):
    evaluation = qtab.evaluate(run, 10, seed=0)
    frame = evaluation.to_pandas()
    assert frame["length"].tolist() == evaluation.lengths.tolist()
    assert len(frame) == 10


def test_an_experiment_has_a_row_for_each_point(tmp_path):
    import pandas as pd

    result = qtab.book.run("example 6.6", runs=2)
    result.save(tmp_path / "points.csv")
    frame = result.to_pandas()
    pd.testing.assert_frame_equal(frame, pd.read_csv(tmp_path / "points.csv"), check_dtype=False)
    assert str(frame["runs"].dtype) == str(frame["capped_episodes"].dtype) == "int64"


def test_a_sweep_keeps_integers_also_where_runs_failed():
    sweep = qtab.sweep("FrozenLake-v1", {"discount": [0.9, 0.99]}, seeds=2, episodes=20)
    assert [str(sweep.to_pandas()[name].dtype) for name in ("setting", "seed", "episodes", "steps")] == ["int64"] * 4
    assert [str(sweep.to_arrow()[name].type) for name in ("setting", "seed", "episodes", "steps")] == ["int64"] * 4
    failed = qtab.sweep("MountainCar-v0", GRID, seeds=2, episodes=20, **DIVERGES)
    assert failed.failed == 2
    frame, table = failed.to_pandas(), failed.to_arrow()
    assert str(frame["steps"].dtype) == "Int64"
    assert frame["steps"].isna().tolist() == [np.isnan(value) for value in failed.columns["steps"]]
    assert table["steps"].null_count == 2
    assert table["steps"].to_pylist()[:2] == failed.columns["steps"][:2].tolist()


@pytest.mark.parametrize(
    ("largest", "dtype", "arrow_type"),
    [(2**63 - 1, "int64", "int64"), (2**63 + 1, "uint64", "uint64"), (2**64, "object", "string")],
    ids=["int64", "uint64", "object"],
)
def test_seeds_of_any_size_stay_exact(largest, dtype, arrow_type):
    seeds = [5, largest - 1, largest]
    frame = qtab.train_many("FrozenLake-v1", seeds=seeds, episodes=2).to_pandas()
    assert (str(frame["seed"].dtype), frame["seed"].tolist()) == (dtype, seeds)
    sweep = qtab.sweep("FrozenLake-v1", {"discount": [0.9]}, seeds=seeds, episodes=2)
    assert sweep.values("seed", 0).tolist() == seeds
    frame, table = sweep.to_pandas(), sweep.to_arrow()
    assert (str(frame["seed"].dtype), frame["seed"].tolist()) == (dtype, seeds)
    assert len(frame.groupby("seed")) == 3
    assert (str(table["seed"].type), list(map(int, table["seed"].to_pylist()))) == (arrow_type, seeds)


@pytest.mark.parametrize(
    ("name", "values", "cells", "arrow_cells"),
    [
        ("initial_q", [0.5, (-1, 1)], [0.5, "[-1, 1]"], ["0.5", "[-1, 1]"]),
        ("max_episode_steps", [None, 30], [None, 30], [None, 30]),
        ("discount", [1, 0.5], [1.0, 0.5], [1.0, 0.5]),
        ("action_mask", [True, False], [True, False], [True, False]),
    ],
)
def test_the_values_of_a_setting_keep_their_types(name, values, cells, arrow_cells):
    sweep = qtab.sweep("Taxi-v4", {name: values}, seeds=1, episodes=2)
    assert list(zip(sweep.columns[name].tolist(), map(type, sweep.columns[name].tolist()), strict=True)) == [
        (cell, type(cell)) for cell in cells
    ]
    assert sweep.to_pandas()[name].tolist() == cells
    assert sweep.to_arrow()[name].to_pylist() == arrow_cells


def test_a_column_is_the_same_in_any_order_of_its_values():
    for values in ([1.5, True], [2**60 + 1, 0.5], [2**64, None, 7]):
        column, reversed_column = cell_column(values), cell_column(values[::-1])
        assert [*map(type, column)] == [*map(type, values)]
        assert column.tolist() == reversed_column.tolist()[::-1] == values
        table = arrow_table({"forwards": column, "backwards": reversed_column})
        text = [None if value is None else str(value) for value in values]
        assert table["forwards"].to_pylist() == table["backwards"].to_pylist()[::-1] == text


def test_without_pandas_the_error_names_what_to_install(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(
        ModuleNotFoundError, match=r"this needs pandas, which is not installed; run: pip install .*pandas"
    ):
        run.to_pandas()
