"""Upper-confidence-bound action selection."""

import math
from typing import Any

import numpy as np
import pytest

import qtab

BANDIT = "qtab/KArmedBandit-v0"


def test_every_action_is_tried_before_any_is_repeated() -> None:
    run = qtab.train(BANDIT, exploration="ucb", ties="first", seed=0, episodes=10, record=10)
    assert [one.actions[0] for one in run.recordings] == list(range(10))


def test_actions_have_the_largest_bound() -> None:
    run = qtab.train(BANDIT, exploration="ucb", confidence=1.5, seed=3, episodes=300, record=300)
    counts, sums = np.zeros(10), np.zeros(10)
    for time, (recording, reward) in enumerate(zip(run.recordings, run.episode_returns, strict=True), 1):
        action = recording.actions[0]
        if counts.all():
            bounds = sums / counts + 1.5 * np.sqrt(math.log(time) / counts)
            assert bounds[action] == pytest.approx(bounds.max())
        counts[action] += 1
        sums[action] += reward


@pytest.mark.parametrize("algorithm", ["q_learning", "expected_sarsa", "n_step_sarsa", "dyna_q"])
def test_it_solves_a_lake_that_is_not_slippery(algorithm: Any) -> None:
    run = qtab.train(
        "FrozenLake-v1",
        env_kwargs={"is_slippery": False},
        algorithm=algorithm,
        exploration="ucb",
        confidence=0.5,
        initial_q=0.0,
        episodes=2000,
        seed=0,
    )
    assert qtab.evaluate(run, 1, seed=0).mean_return == 1.0
    assert qtab.verify(run, episodes=50).equal


def test_its_choices_are_explained_by_their_bounds() -> None:
    run = qtab.train("FrozenLake-v1", exploration="ucb", ties="random", seed=1, episodes=30)
    explanation = qtab.explain(run, 29)
    choice = explanation[0].choice
    assert choice.reason == "upper bound"
    assert choice.values[choice.action] == max(choice.values)
    assert "upper bound: Q + c" in str(explanation)


def test_a_resumed_run_keeps_its_counts() -> None:
    chosen: dict[str, Any] = {"exploration": "ucb", "seed": 4, "episodes": 200}
    whole = qtab.train("FrozenLake-v1", **chosen)
    part = qtab.train("FrozenLake-v1", callback=lambda progress: progress.episodes < 80, callback_every=1, **chosen)
    assert not part.completed
    assert qtab.resume(part).tables.tobytes() == whole.tables.tobytes()


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"confidence": -1.0}, "confidence must not be negative, got -1.0"),
        ({"epsilon": 0.1}, "epsilon applies to exploration 'epsilon_greedy', not to 'ucb', got 0.1"),
        ({"temperature": 1.0}, "temperature applies to exploration 'softmax', not to 'ucb', got 1.0"),
        (
            {"discretizer": "tiles"},
            "exploration must be 'epsilon_greedy' or 'softmax' for discretizer 'tiles', got 'ucb'",
        ),
    ],
    ids=str,
)
def test_what_does_not_apply_is_refused(settings: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueError, match=rf"^{text}"):
        qtab.Config(exploration="ucb", **settings)


def test_confidence_needs_bounds() -> None:
    with pytest.raises(ValueError, match=r"^confidence applies to exploration 'ucb', not to 'epsilon_greedy', got 2.0"):
        qtab.Config(confidence=2.0)
