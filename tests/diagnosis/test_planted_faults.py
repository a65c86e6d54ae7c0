"""A planted fault is found, and the advised change removes it; a run that solves its task has no findings."""

from dataclasses import dataclass
from typing import Any

import pytest

import qtab
from qtab.diagnosis.checks import CHECKS

LAKE, TAXI, CAR = "FrozenLake-v1", "Taxi-v4", "MountainCar-v0"
TILES: dict[str, Any] = {"preset": "solved", "episodes": 200}


@dataclass(frozen=True)
class Fault:
    """Settings with one fault."""

    finding: str
    env: str
    settings: dict[str, Any]
    beside: tuple[str, ...] = ()
    """What the fault causes as well."""
    seeds: tuple[int, ...] = (0,)


FAULTS = [
    Fault("horizon", CAR, {"preset": "solved", "discount": 0.8, "episodes": 1000}),
    Fault("grid too coarse", CAR, {"scale": (5, 50), "discount": 1.0, "epsilon": 0.0, "initial_q": 0.0}),
    Fault(
        "coverage",
        CAR,
        {"scale": (100, 1000), "discount": 1.0, "epsilon": 0.0, "initial_q": 0.0, "episodes": 300},
    ),
    Fault("exploration", LAKE, {"epsilon": 0.0, "episodes": 2000}),
    Fault(
        "lasting exploration",
        "CliffWalking-v1",
        {"algorithm": "sarsa", "epsilon": 0.5, "epsilon_schedule": "constant"},
        beside=("greedy loop",),
    ),
    Fault(
        "lasting bonus",
        "CliffWalking-v1",
        {"count_bonus": 100.0, "episodes": 500, "max_episode_steps": 300},
        beside=("too short",),
    ),
    Fault("limits too narrow", CAR, {**TILES, "low": (-0.7, -0.02), "high": (-0.3, 0.02)}),
    Fault("limits too wide", CAR, {**TILES, "low": (-100, -10), "high": (100, 10)}),
    Fault("slow learning", LAKE, {"learning_rate": 1e-4, "episodes": 1000}),
    Fault(
        "noisy values",
        "Blackjack-v1",
        {"learning_rate": 0.5, "learning_rate_schedule": "constant", "episodes": 4000},
    ),
    Fault("too short", TAXI, {"episodes": 300}, beside=("greedy loop",)),
    Fault("too optimistic", TAXI, {"initial_q": 1e4, "episodes": 300}, beside=("greedy loop",)),
    Fault("too pessimistic", TAXI, {"initial_q": -1000.0, "epsilon": 0.0, "episodes": 500}, beside=("coverage",)),
    Fault(
        "time-outs treated as terminal",
        TAXI,
        {"on_truncation": "terminate", "max_episode_steps": 30, "episodes": 500},
        beside=("too short", "greedy loop"),
    ),
    Fault("unlucky seed", LAKE, {"preset": "solved", "episodes": 500}, beside=("too short",), seeds=(13, 27)),
]


def test_every_check_has_a_planted_fault() -> None:
    # Three have other tests, and not solved is in each of these.
    elsewhere = {"divergence", "short time limit", "greedy loop", "not solved"}
    assert {fault.finding for fault in FAULTS} | elsewhere == set(CHECKS)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.finding)
def test_a_planted_fault_is_found_alone(fault: Fault) -> None:
    for seed in fault.seeds:
        diagnosis = qtab.diagnose(qtab.train(fault.env, seed=seed, **fault.settings))
        assert diagnosis.solved is False
        assert fault.finding in diagnosis
        assert {"not solved", fault.finding} <= set(diagnosis.names) <= {"not solved", fault.finding, *fault.beside}
        finding = diagnosis[fault.finding]
        assert finding.evidence
        assert all(isinstance(value, (int, float)) for value in finding.evidence.values())
        assert finding.changes


MENDED_AT_ONCE = (
    *("exploration", "lasting bonus", "limits too narrow", "limits too wide", "slow learning", "too optimistic"),
    "time-outs treated as terminal",
)


@pytest.mark.slow
@pytest.mark.parametrize(
    "fault", [fault for fault in FAULTS if fault.finding in MENDED_AT_ONCE], ids=lambda fault: fault.finding
)
def test_the_advised_change_removes_the_finding(fault: Fault) -> None:
    run = qtab.train(fault.env, seed=0, **fault.settings)
    change = qtab.diagnose(run, seeds=0)[fault.finding].changes[0]
    assert fault.finding not in qtab.diagnose(qtab.train(config=run.config, **change), seeds=0)


def test_values_that_diverge_are_found_before_anything_else() -> None:
    run = qtab.train(
        CAR, seed=0, algorithm="sarsa_lambda", preset="solved", learning_rate=1.9, traces="accumulating", episodes=20
    )
    diagnosis = qtab.diagnose(run)
    assert diagnosis.names == ("not solved", "divergence")
    assert diagnosis["divergence"].evidence["largest value"] > 1e4


def test_a_run_that_overflowed_is_diagnosed() -> None:
    with pytest.raises(OverflowError) as caught:
        qtab.train(
            CAR,
            seed=0,
            algorithm="sarsa_lambda",
            preset="solved",
            learning_rate=2.0,
            traces="accumulating",
            episodes=2000,
        )
    diagnosis = qtab.diagnose(caught.value.run)  # type: ignore[attr-defined]
    assert "divergence" in diagnosis
    assert "nan" not in str(diagnosis)
    tried = diagnosis.what_if(2)
    assert "diverged" in str(tried)
    assert tried.best.comparison is None
    assert tried.best.returns.mean() > -200


@pytest.mark.parametrize(
    ("env", "preset", "seeds"),
    [
        (CAR, "solved", 1),
        (LAKE, "solved", 2),
        (LAKE, "tuned", 2),
        ("FrozenLake8x8-v1", "solved", 1),
        ("CliffWalking-v1", "solved", 3),
        ("CliffWalking-v1", "book", 2),
        ("CliffWalkingSlippery-v1", "solved", 1),
        ("qtab/DynaMaze-v0", "book", 1),
        pytest.param("qtab/AccessControlQueue-v0", "book", 1, marks=pytest.mark.slow),
        (TAXI, "solved", 2),
        ("MountainCarContinuous-v0", "solved", 1),
        pytest.param("CartPole-v1", "solved", 1, marks=pytest.mark.slow),
        pytest.param("Acrobot-v1", "solved", 1, marks=pytest.mark.slow),
    ],
)
def test_the_presets_that_solve_their_task_have_no_findings(env: str, preset: str | None, seeds: int) -> None:
    for seed in range(seeds):
        diagnosis = qtab.diagnose(qtab.train(env, preset=preset, seed=seed))
        assert diagnosis.solved
        assert diagnosis.names == ()
        assert "nothing to advise" in str(diagnosis)
