"""The ranking of settings, and the best ones trained again with other seeds."""

import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.sweeps.run_records import SUMMARY_COLUMNS
from support.environments import make_brittle
from support.sweeps import CAR, GRID, SMALL

LAKE: dict[str, Any] = {"grid": {"learning_rate": [0.1, 0.5], "algorithm": ["sarsa", "q_learning"]}, "seeds": 4}


def table(returns: list[list[float | None]]) -> qtab.Sweep:
    """A sweep with these final returns of each setting; None is a run that failed."""
    flat = [value for values in returns for value in values]
    columns: dict[str, Any] = {"setting": np.repeat(np.arange(len(returns)), [len(values) for values in returns])}
    columns["seed"] = np.arange(len(flat))
    columns |= {name: np.array([np.nan if value is None else value for value in flat]) for name in SUMMARY_COLUMNS}
    columns["error"] = np.array(["no" if value is None else None for value in flat], dtype=object)
    settings = [{"learning_rate": 0.1 * (1 + index)} for index in range(len(returns))]
    return qtab.Sweep(CAR, settings, (0, 1), columns, 100, [b""] * len(flat))


def test_a_failed_run_counts_as_the_worst_run_of_the_sweep() -> None:
    sweep = table([[-100.0, None], [-150.0, -140.0], [-200.0, -110.0]])
    # Without its failed run the first setting would be the best.
    assert sweep.mean_final_returns().tolist() == [-150.0, -145.0, -155.0]
    assert sweep.ranking() == [1, 0, 2]


def test_a_setting_whose_runs_all_failed_is_last_and_one_without_runs_is_left_out() -> None:
    sweep = table([[None, None], [], [-200.0, -110.0]])
    assert sweep.ranking() == [2, 0]
    assert table([[], []]).ranking() == []
    with pytest.raises(ValueError, match="a sweep without finished runs has no best setting"):
        table([[], []]).confirm()


@pytest.mark.slow
def test_the_best_settings_are_trained_with_other_seeds(tmp_path: Path) -> None:
    sweep = qtab.sweep("FrozenLake-v1", **LAKE, episodes=50)
    found = sweep.confirm(5, top=2)
    assert found.chosen == tuple(sweep.ranking()[:2])
    assert found.confirmed.seeds == (4, 5, 6, 7, 8)
    for place, setting in enumerate(found.chosen):
        given: dict[str, Any] = dict(sweep.settings[setting])
        runs = qtab.train_many("FrozenLake-v1", seeds=range(4, 9), episodes=50, **given)
        assert found.confirmed.values("final_return", place).tolist() == runs.final_returns().tolist()
        assert found.mean(place).estimate == runs.final_returns().mean()
    lines = str(found).splitlines()
    assert len(lines) == 2
    assert lines[0].startswith(f"setting {found.chosen[0]} (learning_rate ")
    assert "over 5 other seeds; " in lines[0]
    assert repr(found).startswith("<Confirmation of 2 of 4 settings: <Sweep of FrozenLake-v1: 2 settings, 10 runs")


def test_a_loaded_sweep_is_confirmed_as_the_sweep_itself(tmp_path: Path) -> None:
    path = tmp_path / "study.db"
    grid: dict[str, Any] = {"scale": [(5, 50), (10, 100)], "initial_q": [0.0, (-1.0, 0.0)]}
    direct = qtab.sweep(CAR, grid, seeds=2, episodes=20, store=path).confirm([7, 3], top=4)
    loaded = qtab.load_sweep(path).confirm([7, 3], top=4, store=tmp_path / "confirmed.db")
    assert loaded.chosen == direct.chosen
    for name, column in direct.confirmed.columns.items():
        assert loaded.confirmed.columns[name].tolist() == column.tolist()


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"seeds": [9, 1]}, ValueError, "seeds must be other seeds than those of the sweep, got 1, which it used"),
        ({"seeds": 0}, ValueError, "seeds must be an integer from 1"),
        ({"seeds": 10**12}, ValueError, "seeds must be an integer from 1 to"),
        ({"seeds": "x"}, TypeError, "seeds must be an integer or a sequence"),
        ({"top": 0}, ValueError, "top must be an integer from 1 to 6, got 0"),
        ({"top": 7}, ValueError, "top must be an integer from 1 to 6, got 7"),
        ({"env": 3}, TypeError, "env must be"),
        ({"env": "Acrobot-v1"}, ValueError, "got another one: it was MountainCar-v0, and is now Acrobot"),
    ],
)
def test_bad_arguments_are_refused(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    sweep = qtab.sweep(CAR, GRID, **SMALL)
    with pytest.raises(error, match=message):
        sweep.confirm(**arguments)


@pytest.mark.slow
def test_a_store_does_not_choose_a_module_to_import(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "lakes.py").write_text(
        "import gymnasium\ngymnasium.register('Lake-v7', 'gymnasium.envs.toy_text.frozen_lake:FrozenLakeEnv')\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    path = tmp_path / "study.db"
    arguments: dict[str, Any] = {"episodes": 5, "max_episode_steps": 20, "discretizer": "identity", "threads": 1}
    try:
        qtab.sweep(None, {"learning_rate": [0.1, 0.2]}, 2, config={"env": "lakes:Lake-v7"}, store=path, **arguments)
        sweep = qtab.load_sweep(path)
        assert len(sweep.confirm(2, threads=1).confirmed) == 2
    finally:
        gym.registry.pop("Lake-v7", None)
        sys.modules.pop("lakes", None)  # other tests have modules of this name
    with pytest.raises(
        ValueError, match=r"the environment '.*Lake-v7' of the store must be registered, or given as env="
    ):
        sweep.confirm(2)
    assert "Lake-v7" not in gym.registry


def test_an_array_that_a_store_does_not_keep_is_said(tmp_path: Path) -> None:
    path = tmp_path / "study.db"
    lake: dict[str, Any] = {"initial_q": np.zeros((16, 4)), "episodes": 5, "store": path}
    sweep = qtab.sweep("FrozenLake-v1", {"learning_rate": [0.1, 0.2]}, 2, **lake)
    assert len(sweep.confirm(3).confirmed) == 3
    with pytest.raises(ValueError, match="a store does not keep an array initial_q"):
        qtab.load_sweep(path).confirm(3)


@pytest.mark.slow
def test_runs_that_fail_again_are_counted() -> None:
    sweep = qtab.sweep(make_brittle, {"learning_rate": [0.1, 0.5]}, [0, 1], episodes=2, scale=(10, 100), threads=1)
    found = sweep.confirm([2, 3, 4], threads=1)
    assert "over 3 other seeds, 1 failed; " in str(found)


@pytest.mark.parametrize("setting", [-1, 6, 99, 10**30])
def test_a_setting_that_does_not_exist_is_refused(setting: int) -> None:
    sweep = qtab.sweep(CAR, GRID, **SMALL)
    for call in (sweep.curves, lambda index: sweep.values("final_return", index)):
        with pytest.raises(ValueError, match=f"setting must be an integer from 0 to 5, got {setting}"):
            call(setting)
    with pytest.raises(KeyError, match=r"column must be one of setting, .*, got 'final_returns' \(did you mean"):
        sweep.values("final_returns", 0)
    with pytest.raises(TypeError, match="setting must be an integer"):
        sweep.curves("x")  # type: ignore[arg-type]


MIXED: dict[str, Any] = {"algorithm": ["sarsa", "q_learning", "expected_sarsa"], "learning_rate": [0.1, 0.5]}


def test_the_best_of_each_algorithm_are_confirmed_in_one_call() -> None:
    sweep = qtab.sweep("FrozenLake-v1", MIXED, 2, episodes=30)
    ranking = sweep.ranking()
    best = {name: [i for i in ranking if sweep.settings[i]["algorithm"] == name] for name in MIXED["algorithm"]}
    found = sweep.confirm(2, per="algorithm")
    assert sorted(found.chosen) == sorted(indices[0] for indices in best.values())
    assert list(found.chosen) == [index for index in ranking if index in found.chosen]
    assert [setting["algorithm"] for setting in found.confirmed.settings] == [
        sweep.settings[index]["algorithm"] for index in found.chosen
    ]
    assert len(sweep.confirm(2, per="algorithm", top=2).chosen) == 6


def test_any_settings_are_confirmed_in_the_order_given(tmp_path: Path) -> None:
    path = tmp_path / "study.db"
    sweep = qtab.sweep("FrozenLake-v1", MIXED, 2, episodes=30, store=path)
    for table in (sweep, qtab.load_sweep(path)):
        found = table.confirm([7, 8], settings=[4, 0])
        assert found.chosen == (4, 0)
        assert [dict(setting) for setting in found.confirmed.settings] == [MIXED_SETTINGS[4], MIXED_SETTINGS[0]]


MIXED_SETTINGS = qtab.designs.grid(MIXED)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"settings": [6]}, ValueError, "settings must be an integer from 0 to 5, got 6"),
        ({"settings": []}, ValueError, r"settings must hold different indices, at least one, got \[\]"),
        ({"settings": [1, 1]}, ValueError, r"settings must hold different indices, at least one, got \[1, 1\]"),
        ({"settings": 3}, TypeError, "settings must be a sequence of indices of settings, got 3"),
        ({"settings": [1], "top": 2}, ValueError, "settings must be given without top and per"),
        ({"settings": [1], "per": "algorithm"}, ValueError, "settings must be given without top and per"),
        ({"per": "algoritm"}, ValueError, r"per must be .*'algorithm'.*got 'algoritm'"),
        ({"per": "algorithm", "top": 9}, ValueError, "top must be an integer from 1 to 6, got 9"),
    ],
)
def test_bad_choices_of_settings_are_refused(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    sweep = qtab.sweep("FrozenLake-v1", MIXED, 2, episodes=5)
    with pytest.raises(error, match=message):
        sweep.confirm(2, **arguments)
