"""Schedules: how learning rates and exploration rates decay."""

from functools import partial
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.reference.parts.schedules import Schedule


def course(kind: str, value: float, least: float, decay: float | None, warm_up: int, episodes: int) -> list[float]:
    schedule = Schedule(kind, value, least, decay, warm_up, episodes)
    values = []
    for _ in range(episodes):
        values.append(schedule.value)
        schedule.end_episode()
    return values


def test_a_constant_rate_does_not_change() -> None:
    assert course("constant", 0.5, 0.0, None, 0, 3) == [0.5] * 3


def test_a_linear_rate_decreases_by_the_same_amount() -> None:
    assert course("linear", 1.0, 0.0, None, 0, 4) == [1.0, 0.75, 0.5, 0.25]
    assert course("linear", 1.0, 0.5, None, 2, 4) == [1.0, 1.0, 1.0, 0.75]


def test_an_exponential_rate_decays_to_its_minimum() -> None:
    assert course("exponential", 1.0, 0.2, 0.5, 0, 5) == [1.0, 0.5, 0.25, 0.2, 0.2]
    assert course("exponential", 1.0, 0.0, 0.0, 1, 3) == [1.0, 1.0, 0.0]


def fewer_episodes_than(count: int, progress: qtab.Progress) -> bool:
    return progress.episodes < count


def test_the_learning_rate_follows_its_schedule() -> None:
    # One action in one cell, and always the target -1: the value after each episode shows its learning rate.
    table = np.full((1, 1, 3), -9.0)
    table[0, 0, 0] = 0.0
    value, values = 0.0, []
    for rate in course("exponential", 0.5, 0.1, 0.5, 1, 5):
        value += rate * (-1.0 - value)
        values.append(value)
    seen = []
    for count in range(1, 6):
        run = qtab.train(
            "MountainCar-v0",
            seed=0,
            episodes=5,
            callback=partial(fewer_episodes_than, count),
            callback_every=1,
            scale=(0.1, 0.1),
            initial_q=table,
            epsilon=0.0,
            discount=0.0,
            max_episode_steps=1,
            learning_rate=0.5,
            learning_rate_schedule="exponential",
            learning_rate_decay=0.5,
            min_learning_rate=0.1,
            learning_rate_warm_up=1,
        )
        seen.append(float(run.q_table[0, 0, 0]))
    assert seen == values


@pytest.mark.parametrize("algorithm", ["q_learning", "n_step_sarsa", "sarsa_lambda"])
def test_the_visits_schedule_averages_the_targets(algorithm: Any) -> None:
    run = qtab.train(
        "MountainCar-v0",
        algorithm=algorithm,
        seed=0,
        episodes=7,
        scale=(0.1, 0.1),
        learning_rate=1.0,
        learning_rate_schedule="visits",
        discount=0.0,
        initial_q=5.0,
    )
    # Every reward is -1, and the first visit replaces the initial value.
    assert set(run.tables.ravel().tolist()) <= {-1.0, 5.0}


def test_exploration_ends_with_its_schedule() -> None:
    table = np.full((19, 15, 3), -1.0)
    table[..., 2] = 0.0
    run = qtab.train(
        "MountainCar-v0",
        seed=0,
        episodes=4,
        record=4,
        initial_q=table,
        learning_rate=0.0,
        epsilon=1.0,
        epsilon_schedule="exponential",
        epsilon_decay=0.0,
        epsilon_warm_up=1,
    )
    assert [len(set(recording.actions)) for recording in run.recordings] == [3, 3, 1, 1]


def test_constant_initial_values_draw_no_random_numbers() -> None:
    settings: dict[str, Any] = {"seed": 0, "episodes": 1, "learning_rate": 0.0}
    same = qtab.train("MountainCar-v0", initial_q=2.5, **settings)
    drawn = qtab.train("MountainCar-v0", initial_q=(2.5, 2.5), **settings)
    assert (same.tables == 2.5).all()
    assert same.tables.tobytes() == drawn.tables.tobytes()
    given = qtab.train("MountainCar-v0", initial_q=np.full((19, 15, 3), 2.5), record=1, **settings)
    constant = qtab.train("MountainCar-v0", initial_q=2.5, record=1, **settings)
    assert constant.recordings[0].actions == given.recordings[0].actions


def test_random_ties_take_every_greedy_action() -> None:
    settings: dict[str, Any] = {"seed": 0, "episodes": 1, "initial_q": 0.0, "learning_rate": 0.0, "epsilon": 0.0}
    first = qtab.train("MountainCar-v0", ties="first", record=1, **settings)
    anyone = qtab.train("MountainCar-v0", ties="random", record=1, **settings)
    assert set(first.recordings[0].actions) == {0}
    assert set(anyone.recordings[0].actions) == {0, 1, 2}


def test_a_low_temperature_is_greedy_and_a_high_one_is_random() -> None:
    table = np.zeros((19, 15, 3))
    table[..., 1] = 1.0
    settings: dict[str, Any] = {"seed": 0, "episodes": 1, "initial_q": table, "learning_rate": 0.0, "record": 1}
    cold = qtab.train("MountainCar-v0", exploration="softmax", temperature=1e-3, **settings)
    hot = qtab.train("MountainCar-v0", exploration="softmax", temperature=1e3, **settings)
    assert set(cold.recordings[0].actions) == {1}
    counts = np.bincount(hot.recordings[0].actions, minlength=3)
    assert (counts > 40).all()
