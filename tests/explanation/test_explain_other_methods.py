"""Explanations of Monte Carlo, differential and planned updates and of preferences give the table, bit for bit."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import qtab
from qtab.config.options import AVERAGE_REWARD, MONTE_CARLO, PREFERENCES, WITH_STATE_VALUES, fixed_settings
from qtab.explanation.policy_update import PolicyUpdate
from qtab.explanation.records import Update
from support.learners.explained_algorithms import PLANNED
from support.learners.learner_settings import run_settings

LAKE = "FrozenLake-v1"
CORRIDOR = "qtab/ShortCorridor-v0"
SHORT: dict[str, Any] = {"seed": 5, "episodes": 40, "max_episode_steps": 9}
EXAMPLES = max(1, (settings.default or settings()).max_examples // 10)


def last_episode(run: qtab.Run) -> tuple[qtab.Explanation, qtab.Run]:
    """The explanation of all steps of the last episode, and the run before it."""
    episode = len(run.episode_returns) - 1
    before = qtab.train(
        config=run.config, callback=lambda progress: progress.episodes < episode, callback_every=episode
    )
    return qtab.explain(run, episode, steps=10_000), before


def apply(update: Update, table: NDArray[np.float64]) -> None:
    (row,), (size,), action = update.rows, update.step_sizes, update.action
    assert update.before == table[row, action]
    assert update.error == update.target - update.before
    table[row, action] += size * update.error
    assert update.after == table[row, action]


def ascend(update: PolicyUpdate, preferences: NDArray[np.float64], algorithm: str) -> None:
    rows = list(update.rows)
    assert update.before == tuple(map(tuple, preferences[rows].tolist()))
    assert update.error == update.target - update.reference
    for row in rows if algorithm != "actor_critic_lambda" else ():
        for action, part in enumerate(update.gradient):
            preferences[row, action] += update.step_size * (update.power * update.error) * part
    if algorithm == "actor_critic_lambda":
        for row, traces in dict(zip(rows, update.traces, strict=True)).items():
            preferences[row] += update.step_size * update.error * np.array(traces)
    assert update.after == tuple(map(tuple, preferences[rows].tolist()))
    assert sum(update.probabilities_after) == pytest.approx(1.0)


@pytest.mark.parametrize("algorithm", MONTE_CARLO)
@pytest.mark.parametrize("on_truncation", ["bootstrap", "terminate"])
def test_the_returns_of_an_episode_give_the_table_after_it(algorithm: Any, on_truncation: Any) -> None:
    run = qtab.train("CliffWalking-v1", algorithm=algorithm, on_truncation=on_truncation, **SHORT)
    explanation, before = last_episode(run)
    table, discount = before.tables[0].copy(), run.config.discount
    learned = 0
    for step in reversed(explanation.steps):
        for update in step.updates:
            assert update.step == step.step
            following = 0.0 if update.bootstrap is None else update.bootstrap
            assert update.target == step.future_return == discount * following + step.reward
            apply(update, table)
            learned += 1
        assert bool(step.note) == (not step.updates)
    assert learned > 0
    assert table.tobytes() == run.tables.tobytes()
    last = explanation[-1].updates
    assert all((update.bootstrap is None) == (on_truncation == "terminate") for update in last)
    assert "G = -" in str(explanation)
    if algorithm == "monte_carlo_es":
        assert "exploring start: drawn with probability 0.25" in str(explanation)


@pytest.mark.parametrize("algorithm", AVERAGE_REWARD)
def test_the_average_reward_is_followed_through_an_episode(algorithm: Any) -> None:
    run = qtab.train(LAKE, algorithm=algorithm, initial_q=(-1.0, 1.0), reward_learning_rate=0.3, **SHORT)
    # The first of two episodes ends in a terminal state, so that its last update waits for the second.
    ended = np.flatnonzero(run.terminated[:-1])
    episodes = int(ended[0]) + 2
    run = qtab.train(config=run.config, episodes=episodes)
    explanation, before = last_episode(run)
    average, table = before.average_reward, before.tables[0].copy()
    assert average is not None
    for step in explanation.steps:
        for update in step.updates:
            assert update.average_reward == average
            assert update.target == (update.rewards[0] - average) + (update.bootstrap or 0.0)
            average += 0.3 * update.error
            apply(update, table)
    assert explanation[0].updates[0].step == -1
    assert explanation[0].target == explanation[0].updates[1].target
    assert "of the last step of the episode before" in str(explanation)
    assert (average, table.tobytes()) == (run.average_reward, run.tables.tobytes())


def test_the_queue_of_prioritized_sweeping_gives_the_table() -> None:
    run = qtab.train("CliffWalking-v1", algorithm="prioritized_sweeping", **SHORT)
    explanation, before = last_episode(run)
    table = before.tables[0].copy()
    for step in explanation.steps:
        assert not step.updates
        for update in step.planning:
            apply(update, table)
    assert table.tobytes() == run.tables.tobytes()
    assert "only those that were planned" in str(explanation)


@pytest.mark.parametrize("algorithm", PREFERENCES)
def test_the_updates_of_an_episode_give_the_preferences_after_it(algorithm: Any) -> None:
    env, limit = ("qtab/KArmedBandit-v0", 1) if algorithm == "gradient_bandit" else (CORRIDOR, 9)
    settings = {"discount": 0.9, **fixed_settings(algorithm), **SHORT, "max_episode_steps": limit}
    run = qtab.train(env, algorithm=algorithm, learning_rate=0.01, **settings)
    explanation, before = last_episode(run)
    preferences = before.tables[0].copy()
    known = float(before.tables[1][0, 0]) if algorithm in WITH_STATE_VALUES else None
    for step in explanation.steps:
        (update,) = step.policy_updates
        assert update.step == step.step
        assert step.choice.probability == pytest.approx(update.probabilities_before[update.action], abs=0.2)
        assert update.value_before == known
        known = update.value_after
        ascend(update, preferences, algorithm)
    assert preferences.tobytes() == run.tables[0].tobytes()
    assert known == (None if len(run.tables) == 1 else run.tables[1][0, 0])
    assert "π(a | S)" in str(explanation)
    assert "π(a | S)" in explanation._repr_html_()
    assert "π(a | S)" in explanation[0]._repr_html_()


@settings(max_examples=EXAMPLES, deadline=None)
@given(st.sampled_from((*MONTE_CARLO, *AVERAGE_REWARD, *PLANNED, *PREFERENCES)).flatmap(run_settings))
def test_random_settings_are_explained(chosen: dict[str, Any]) -> None:
    try:
        run = qtab.train("MountainCar-v0", **chosen)
    except OverflowError:
        return
    explanation = qtab.explain(run, len(run.episode_returns) - 1, steps=10_000)
    changed = [part for step in explanation.steps for part in (*step.updates, *step.planning, *step.policy_updates)]
    assert changed or all(step.note for step in explanation.steps)
    assert str(explanation)
