"""Optuna drives sweeps, as examples/optuna_study.py shows."""

import runpy
from pathlib import Path
from typing import Any

import optuna
import pytest

import qtab

EXAMPLE = Path(__file__).parents[2] / "examples" / "optuna_study.py"


@pytest.mark.filterwarnings("ignore::optuna.exceptions.ExperimentalWarning")
def test_a_trial_gets_the_mean_return_of_its_setting():
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    example = runpy.run_path(str(EXAMPLE))
    study = example["search"](batches=2, size=2, episodes=100)
    assert [trial.state.name for trial in study.trials] == ["COMPLETE"] * 4
    for trial in study.trials:
        shared: dict[str, Any] = {"preset": "solved", "learning_rate_schedule": "linear", "episodes": 100}
        runs = qtab.train_many("MountainCar-v0", seeds=example["SEEDS"], **shared, **trial.params)
        assert trial.value == runs.final_returns(100).mean()
