"""A run whose values have overflowed by its end is an error, however it was trained."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.parity import run_of

CAR = "MountainCar-v0"
GROWING: dict[str, Any] = {"discretizer": "tiles", "tilings": 1, "tiles": 4, "learning_rate": 2.0, "discount": 1.0}
GROWING |= {"episodes": 300, "initial_q": 0.0}
MESSAGE = r"^the action values overflowed by episode 299 .*learning_rate are too large"


class Huge(gym.Env[Any, Any]):
    """Rewards of which two have no finite difference."""

    observation_space = gym.spaces.Discrete(1)
    action_space = gym.spaces.Discrete(2)

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[int, dict[str, Any]]:
        super().reset(seed=seed)
        return 0, {}

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        return 0, 1.7e308 * float(np.sign(self.np_random.uniform(-1, 1))), True, False, {}


HUGE: dict[str, Any] = {"epsilon": 1.0, "epsilon_schedule": "constant", "learning_rate": 1.0, "episodes": 50}


def test_train_and_train_many_refuse_values_that_were_not_read_again() -> None:
    with pytest.raises(OverflowError, match=MESSAGE) as single:
        qtab.train(CAR, seed=0, **GROWING)
    for tables in (False, True):
        with pytest.raises(OverflowError, match=MESSAGE) as many:
            qtab.train_many(CAR, [0], tables=tables, **GROWING)
        assert str(many.value) == str(single.value)
        assert len(run_of(many.value)) == 0
    assert run_of(single.value).episode_lengths.sum() > 0


def test_a_sweep_records_them_as_failed() -> None:
    shared = {name: value for name, value in GROWING.items() if name != "learning_rate"}
    study = qtab.sweep(CAR, {"learning_rate": [0.5, 2.0]}, seeds=1, **shared)
    first, second = study.columns["error"].tolist()
    assert first is None
    assert second.startswith("OverflowError: the action values overflowed by episode 299")


@pytest.mark.slow
def test_processes_and_sweeps_of_environments_stepped_in_python_do_as_well() -> None:
    with pytest.raises(OverflowError, match="overflowed by episode 49"):
        qtab.train_many(Huge, 2, threads=1, **HUGE)
    study = qtab.sweep(Huge, {"discount": [1.0]}, seeds=1, **HUGE)
    assert study.columns["error"][0].startswith("OverflowError: the action values overflowed by episode 49")


def test_actions_that_are_missing_from_the_start_are_no_overflow() -> None:
    runs = qtab.train_many("qtab/MaximizationBias-v0", 2, tables=True, episodes=20)
    assert runs.completed
    assert runs.tables is not None
    assert np.isneginf(runs.tables).any()
