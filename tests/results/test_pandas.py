"""Results as data frames: integers stay integers, and the advice without pandas helps."""

import sys
from typing import Any

import numpy as np
import pytest

import qtab

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


def test_without_pandas_the_error_names_what_to_install(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(
        ModuleNotFoundError, match=r"this needs pandas, which is not installed; run: pip install .*pandas"
    ):
        run.to_pandas()
