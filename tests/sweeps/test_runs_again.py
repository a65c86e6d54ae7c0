"""A run of a sweep, trained again: it equals its single run, can be verified, and other results are refused."""

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.environments import make_brittle
from support.parity import assert_same_run
from support.sweeps import CAR, GRID


def test_a_run_of_a_sweep_is_trained_again_and_verified(tmp_path: Path) -> None:
    path = tmp_path / "study.db"
    made = qtab.sweep(CAR, GRID, [7, 3], episodes=12, store=path)
    for table in (made, qtab.load_sweep(path)):
        run = table.run(4, seed=3)
        given: dict[str, Any] = dict(table.settings[4])
        assert_same_run(run, qtab.train(CAR, seed=3, episodes=12, **given))
        assert run.episode_returns.mean() == table.values("mean_return", 4)[1]
        assert qtab.verify(run).equal


def test_other_results_than_those_of_the_table_are_refused() -> None:
    table = qtab.sweep(CAR, GRID, 2, episodes=12)
    table.columns["steps"][5] += 1  # setting 2, seed 1
    assert table.run(2, 0).completed
    with pytest.raises(
        ValueError, match=r"^the run of setting 2 with seed 1 is different here: steps is 2400.0, in the sweep 2401.0$"
    ):
        table.run(2, 1)


@pytest.mark.parametrize(
    ("setting", "seed", "error", "message"),
    [
        (0, 2, ValueError, "seed must be that of a finished run of setting 0, got 2"),
        (9, 0, ValueError, "setting must be an integer from 0 to 1, got 9"),
        (0, "x", TypeError, "seed must be an integer"),
        (1, 1, ValueError, "the run of setting 1 with seed 1 failed: RuntimeError: out of order"),
    ],
)
def test_runs_that_the_table_does_not_have_are_refused(
    setting: int, seed: Any, error: type[Exception], message: str
) -> None:
    table = brittle()
    with pytest.raises(error, match=message):
        table.run(setting, seed)


def brittle() -> qtab.Sweep:
    """A sweep whose second setting has a run that failed."""
    table = qtab.sweep(CAR, {"learning_rate": [0.1, 0.5]}, 2, episodes=2)
    table.columns["error"][3] = "RuntimeError: out of order"
    return table


def test_the_table_of_a_store_takes_the_function_that_made_the_environment(tmp_path: Path) -> None:
    def make() -> gym.Env:
        return gym.make("FrozenLake-v1", is_slippery=False)

    path = tmp_path / "study.db"
    made = qtab.sweep(make, {"epsilon": [0.5]}, 2, episodes=5, store=path)
    table = qtab.load_sweep(path)
    assert_same_run(table.run(0, 1, env=make), made.run(0, 1))
    assert len(table.confirm(2, env=make).confirmed) == 2
    with pytest.raises(ValueError, match="its argument is_slippery was False, and is now True"):
        table.run(0, 1, env=lambda: gym.make("FrozenLake-v1", is_slippery=True))


def test_an_environment_object_is_refused_and_stays_open() -> None:
    table = qtab.sweep("FrozenLake-v1", {"epsilon": [0.5]}, 1, episodes=5)
    with pytest.raises(TypeError, match="env must be an id, an EnvSpec or a function that makes an environment"):
        table.run(0, 0, env=gym.make("FrozenLake-v1"))


@pytest.mark.slow
def test_a_run_on_an_environment_of_ones_own_is_trained_again() -> None:
    table = qtab.sweep(make_brittle, {"learning_rate": [0.1, 0.5]}, [0], episodes=2, scale=(10, 100), threads=1)
    assert table.run(1, 0).episode_returns.mean() == table.values("mean_return", 1)[0]


class Counted(Mapping[str, Any]):
    """Columns that count how often each is read."""

    def __init__(self, columns: Mapping[str, Any]) -> None:
        self.columns, self.reads = columns, Counter[str]()

    def __getitem__(self, name: str) -> Any:
        self.reads[name] += 1
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)


def test_showing_and_ranking_many_settings_does_not_search_all_runs_for_each() -> None:
    settings, seeds = 300, 2
    rates = np.linspace(0.01, 1.0, settings).tolist()
    table = qtab.sweep("FrozenLake-v1", {"learning_rate": rates}, seeds, episodes=5, block=5)
    counted = Counted(table.columns)
    vars(table)["columns"] = counted
    shown = table._repr_html_()
    assert "300 settings, 600 runs, 0 failed; the best 6" in shown
    assert len(table.ranking()) == settings
    assert counted.reads["setting"] + counted.reads["error"] + counted.reads["seed"] < 10
