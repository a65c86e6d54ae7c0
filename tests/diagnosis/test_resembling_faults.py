"""Faults that resemble each other are told apart, and each advice gains. The settings were tuned on other seeds."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import qtab

LAKE, CLIFF, CAR = "FrozenLake-v1", "CliffWalking-v1", "MountainCar-v0"
SHORT: dict[str, Any] = {"max_episode_steps": 200}
SEEDS = (7, 8)


@dataclass(frozen=True)
class Fault:
    """A setting with one fault, and what mends it."""

    name: str
    env: str
    settings: dict[str, Any]
    finding: str
    changes: set[str]
    """A setting of each change that is advised."""


FAULTS = [
    Fault(
        "high rate",
        LAKE,
        {"learning_rate": 1.0, "episodes": 5000},
        "noisy values",
        {"learning_rate", "learning_rate_schedule"},
    ),
    Fault(
        "high rate beside greedy optimism",
        LAKE,
        {"learning_rate": 1.0, "epsilon": 0.0, "initial_q": 1.0, "episodes": 5000},
        "noisy values",
        {"learning_rate", "learning_rate_schedule"},
    ),
    Fault("greedy without optimism", LAKE, {"epsilon": 0.0, "episodes": 5000}, "exploration", {"epsilon"}),
    Fault("no discount factor left", CLIFF, {"discount": 0.0, **SHORT}, "horizon", {"discount"}),
    Fault(
        "no discount factor left, no goal", "CartPole-v1", {"discount": 0.0, "episodes": 1000}, "horizon", {"discount"}
    ),
    Fault(
        "a temperature of 100",
        CLIFF,
        {"algorithm": "sarsa", "exploration": "softmax", "temperature": 100.0, **SHORT},
        "lasting exploration",
        {"temperature", "exploration"},
    ),
    Fault(
        "a confidence of 1000",
        CLIFF,
        {"algorithm": "sarsa", "exploration": "ucb", "confidence": 1000.0, **SHORT},
        "lasting exploration",
        {"confidence", "exploration"},
    ),
    Fault("a bonus of 100", LAKE, {"count_bonus": 100.0}, "lasting bonus", {"count_bonus"}),
    Fault(
        "narrow limits",
        CAR,
        {"preset": "solved", "low": (-0.6, -0.01), "high": (-0.4, 0.01), "episodes": 200},
        "limits too narrow",
        {"low"},
    ),
    Fault(
        "wide limits",
        CAR,
        {"preset": "solved", "low": (-100, -10), "high": (100, 10), "episodes": 200},
        "limits too wide",
        {"low"},
    ),
]


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_the_fault_and_no_other_is_found(fault: Fault) -> None:
    for seed in SEEDS:
        diagnosis = qtab.diagnose(qtab.train(fault.env, seed=seed, **fault.settings), seeds=0)
        assert diagnosis.names == ("not solved", fault.finding)
        changes = diagnosis[fault.finding].changes
        assert len(changes) == len(fault.changes)
        assert all(any(name in change for change in changes) for name in fault.changes)


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_each_of_its_changes_gains(fault: Fault) -> None:
    run = qtab.train(fault.env, seed=SEEDS[0], **fault.settings)
    tried = qtab.diagnose(run, seeds=0).what_if(3)
    assert not tried.failed
    for trial in tried.results:
        assert trial.returns.mean() > tried.returns.mean()


def continuing(steps: int = 5) -> qtab.TabularEnv:
    """Each step pays 1, for ever."""
    return qtab.TabularEnv({0: {0: [(1.0, 0, 1.0, False)]}}, [1.0])


@pytest.mark.parametrize(
    ("env", "settings"),
    [
        (None, {"discount": 0.999, "learning_rate": 1.0, "max_episode_steps": 5, "episodes": 4000}),
        (LAKE, {"count_bonus": 100.0, "episodes": 3000}),
        (CAR, {"preset": "solved", "low": (-100, -10), "high": (100, 10), "episodes": 200}),
        ("qtab/DynaMaze-v0", {"algorithm": "dyna_q_plus", "time_weight": 10.0, "episodes": 10}),
        (LAKE, {"initial_q": 1e6, "learning_rate": 1e-3, "episodes": 100}),
    ],
    ids=["continuing", "count bonus", "wide limits", "time weight", "initial values"],
)
def test_large_values_are_no_divergence(env: str | None, settings: dict[str, Any]) -> None:
    run = qtab.train(continuing() if env is None else env, seed=3, **settings)
    if env is None:  # exactly 1 / (1 - discount)
        assert run.q_table[0, 0] == pytest.approx(1000.0, rel=1e-3)
    assert np.abs(run.tables).max() * run.discretizer.n_active > 100 * np.abs(run.episode_returns).max()
    assert "divergence" in qtab.diagnose(run, seeds=0).unremarkable


def test_values_that_diverged_are_not_checked_further() -> None:
    run = qtab.train(
        CAR, seed=1, algorithm="sarsa_lambda", preset="solved", learning_rate=1.9, traces="accumulating", episodes=20
    )
    diagnosis = qtab.diagnose(run, seeds=0)
    assert diagnosis.names == ("not solved", "divergence")
    assert diagnosis.unremarkable == ()
    assert diagnosis.reasons["noisy values"] == "the values diverged"
    assert "Not checked, as the values diverged: horizon," in str(diagnosis)


def test_what_could_not_be_checked_is_not_called_unremarkable() -> None:
    run = qtab.train("CartPole-v1", seed=0, episodes=100)
    diagnosis = qtab.diagnose(run, seeds=0)
    assert diagnosis.reasons["horizon"] == "no way to a goal is known"
    assert diagnosis.reasons["unlucky seed"] == "no other seeds were trained"
    assert not set(diagnosis.unremarkable) & set(diagnosis.not_made)
    assert set(diagnosis.reasons) == set(diagnosis.not_made)
