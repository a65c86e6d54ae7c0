"""The models of the exercises are qtab's learners: the same numbers to the last bit."""

from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab._utils.arrays import same_bytes
from qtab.config import Config
from qtab.exercises.definitions import tables
from qtab.exercises.exercise import parameters
from qtab.exercises.learner_check import FeatureCheck, LearnerCheck
from qtab.exercises.record import Record
from qtab.reference.dynamic_programming import sweep
from qtab.reference.parts.policies import EpsilonGreedy
from qtab.reference.parts.streams import agent_stream

CONTROL = ["monte_carlo", "sarsa", "q_learning", "expected_sarsa", "n_step_sarsa", "dyna_q", "sarsa_lambda"]
NAMES = {"n": "n_steps"}
"""The names of settings that differ from those of the exercises."""


def checks() -> list[Any]:
    return [
        pytest.param(check, id=f"{name}, {check.title}")
        for name in CONTROL
        for check in qtab.exercises.find(name).checks
    ]


def trained(check: LearnerCheck, first: np.ndarray) -> qtab.Run:
    algorithm: Any = check.model.__name__
    settings: dict[str, Any] = {NAMES.get(name, name): value for name, value in check.settings.items()}
    if isinstance(check, FeatureCheck):
        settings |= {"discretizer": "tiles", "tilings": 4, "tiles": check.tiles, "low": check.low, "high": check.high}
        settings |= {"traces": "accumulating", "trace_cutoff": 0.0}
    if check.model.__name__ == "monte_carlo":
        settings |= {"learning_rate": 1.0, "learning_rate_schedule": "visits"}
    return qtab.train(
        check.env_id,
        algorithm=algorithm,
        episodes=check.episodes,
        max_episode_steps=check.max_episode_steps,
        seed=check.seed,
        bit_generator="PCG64",
        initial_q=first,
        terminal_update="target",
        on_truncation="bootstrap",
        exploration="epsilon_greedy",
        ties="first",
        **settings,
    )


@pytest.mark.parametrize("check", checks())
def test_train_learns_the_same_table(check: LearnerCheck) -> None:
    record = Record()
    check.run(check.model, record, seconds=60.0)
    seen = [event.value for event in record.events if event.quantity == check.table]
    run = trained(check, seen[0])
    assert same_bytes(seen[-1].ravel(), run.tables.ravel())
    assert not np.array_equal(seen[0], seen[-1])
    steps = sum(event.quantity == "action" for event in record.events)
    assert steps == run.episode_lengths.sum()


@pytest.mark.parametrize(("env_id", "max_episode_steps"), [("qtab/RandomWalk-v0", 1000), ("CliffWalking-v1", 20)])
def test_estimate_values_estimates_the_same_values(env_id: str, max_episode_steps: int) -> None:
    first = qtab.exercises.find("td_prediction").checks[0]
    assert isinstance(first, LearnerCheck)
    check = replace(first, env_id=env_id, max_episode_steps=max_episode_steps, episodes=40)
    record, policy = Record(), np.ones(check.states(gym.make(env_id)), dtype=np.int64)  # always to the right

    def observed(env: Any, values: Any, _: Any, *others: Any) -> None:
        check.model(env, values, policy, *others)

    check.run(observed, record, seconds=60.0)
    estimates = qtab.estimate_values(
        check.env_id,
        policy,
        method="td",
        episodes=check.episodes,
        max_episode_steps=max_episode_steps,
        seeds=[check.seed],
        initial_value=0.0,
        **check.settings,
    )
    seen = [event.value for event in record.events if event.quantity == "values"]
    assert same_bytes(seen[-1], estimates.weights[0, -1])
    assert seen[-1].any()


def test_epsilon_greedy_is_the_reference_policy() -> None:
    config = Config("FrozenLake-v1", epsilon=0.3, epsilon_schedule="constant", ties="first", seed=5)
    policy = EpsilonGreedy(config, agent_stream(5, "PCG64"))
    rng, values = agent_stream(5, "PCG64"), np.random.default_rng(0)
    model = qtab.exercises.find("epsilon_greedy").model
    for _ in range(1000):
        now = values.integers(0, 3, size=4).astype(float)
        assert model(now, 0.3, rng) == policy.choose(now, [0])


def test_sample_averages_are_those_of_a_bandit() -> None:
    run = qtab.train(
        "qtab/KArmedBandit-v0",
        algorithm="q_learning",
        episodes=60,
        learning_rate=1.0,
        learning_rate_schedule="visits",
        discount=0.0,
        epsilon=0.5,
        initial_q=0.0,
        seed=3,
        record=60,
    )
    estimates, counts = np.zeros(10), np.zeros(10, dtype=np.int64)
    for recording, reward in zip(run.recordings, run.episode_returns, strict=True):
        (arm,) = recording.actions
        qtab.exercises.find("sample_average").model(estimates, counts, int(arm), float(reward))
    assert same_bytes(estimates, run.q_table.ravel())
    assert (counts > 1).sum() > 3


@pytest.mark.parametrize("env_id", ["CliffWalking-v1", "FrozenLake-v1"])
def test_dynamic_programming_makes_the_same_sweeps(env_id: str) -> None:
    P, rng = tables.transitions(env_id), np.random.default_rng(6)  # noqa: N806 - Gymnasium's name
    policy = rng.dirichlet(np.ones(4), size=len(P))
    values = rng.normal(size=len(P))
    mine = qtab.exercises.find("policy_evaluation").model(P, policy, values, 0.9)
    assert mine.tolist() == sweep(P, values.tolist(), 0.9, policy, in_place=False)
    found, actions = qtab.exercises.find("value_iteration").model(P, 0.9, 0.0)
    expected = [0.0] * len(P)
    while (after := sweep(P, expected, 0.9, None, in_place=True)) != expected:
        expected = after
    assert found.tolist() == expected
    assert actions.dtype == np.int64


def test_solutions_take_the_parameters_of_the_starter_code() -> None:
    for exercise in qtab.exercises.EXERCISES.values():
        namespace: dict[str, Any] = {}
        exec(exercise.starter, namespace)  # noqa: S102 - our own code
        assert parameters(namespace[exercise.name]) == parameters(exercise.model)
