"""``qtab train`` on environments of the book, whose optimum is not known."""

from pathlib import Path

import pytest

import qtab as package
from support.processes.command import qtab_here

ENVS = ("qtab/KArmedBandit-v0", "qtab/MaximizationBias-v0", "qtab/ShortCorridor-v0")


@pytest.mark.parametrize("env", ENVS)
def test_a_run_without_a_known_optimum_is_reported(env: str, tmp_path: Path) -> None:
    done = qtab_here("train", env, "--seed", "1", "--episodes", "20", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "Mean return over the last 20 episodes" in done.stdout
    assert "optimum" not in done.stdout


def test_a_run_without_a_known_optimum_is_diagnosed() -> None:
    run = package.train("qtab/MaximizationBias-v0", seed=0, episodes=100)
    assert "Gymnasium defines no threshold, and no optimum is known" in str(package.diagnose(run))


def test_the_options_of_policy_gradients_are_flags(tmp_path: Path) -> None:
    flags = ("--algorithm", "reinforce_with_baseline", "--value-learning-rate", "0.02", "--learning-rate", "0.002")
    done = qtab_here("train", ENVS[2], *flags, "--seed", "1", "--episodes", "20", "--save", "run.npz", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    config = package.load(tmp_path / "run.npz").config
    assert (config.exploration, config.value_learning_rate, config.learning_rate) == ("softmax", 0.02, 0.002)
