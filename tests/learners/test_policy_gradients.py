"""Policy gradient methods: what they learn, which table is which, and what they refuse."""

import math
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.config.options import PREFERENCES, WITH_STATE_VALUES

CORRIDOR = "qtab/ShortCorridor-v0"
BEST = -6 - 4 * math.sqrt(2)
SHORT: dict[str, Any] = {"seed": 0, "episodes": 40, "max_episode_steps": 60}


def probability_of_right(run: qtab.Run) -> float:
    left, right = run.q_table[0]
    return float(1 / (1 + math.exp(left - right)))


def test_reinforce_finds_the_best_stochastic_policy() -> None:
    runs = qtab.train_many(CORRIDOR, seeds=20, tables=True, episodes=2000)
    assert runs.config.algorithm == "reinforce"
    shares = [probability_of_right(run) for run in runs]
    assert abs(np.mean(shares) - (2 - math.sqrt(2))) < 0.05
    last = runs.episode_returns[:, -500:].mean(axis=1)
    assert abs(last.mean() - BEST) < 4 * last.std() / math.sqrt(20) + 0.2


@pytest.mark.parametrize("algorithm", ["reinforce_with_baseline", "actor_critic_lambda"])
def test_state_values_approach_the_return(algorithm: Any) -> None:
    run = qtab.train(
        CORRIDOR,
        algorithm=algorithm,
        seed=1,
        episodes=4000,
        initial_q=0.0,
        learning_rate=2.0**-10,
        value_learning_rate=2.0**-6 if algorithm == "reinforce_with_baseline" else 2.0**-9,
    )
    # All states look alike: the one value that they share lies between 0 and the return from the first state.
    assert run.episode_returns[-1000:].mean() - 5 < run.values(0) < -3
    assert 0.4 < probability_of_right(run) < 0.75


@pytest.mark.parametrize("algorithm", WITH_STATE_VALUES)
def test_critics_learn_a_lake_that_is_not_slippery(algorithm: Any) -> None:
    run = qtab.train(
        "FrozenLake-v1",
        env_kwargs={"is_slippery": False},
        algorithm=algorithm,
        discount=0.95,
        learning_rate=0.5,
        value_learning_rate=0.2,
        initial_q=0.0,
        seed=0,
        episodes=4000,
    )
    assert run.episode_returns[-500:].mean() > 0.95
    assert qtab.evaluate(run, 1, seed=0).mean_return == 1.0
    assert abs(run.values(0) - 0.95**5) < 0.1


@pytest.mark.parametrize("algorithm", PREFERENCES)
def test_the_tables_hold_preferences_and_state_values(algorithm: Any) -> None:
    run = qtab.train("FrozenLake-v1", algorithm=algorithm, initial_q=0.5, **SHORT)
    assert run.config.exploration == "softmax"
    assert run.q_table.tolist() == run.tables[0].tolist()
    assert run.policy.tolist() == np.argmax(run.tables[0], axis=1).tolist()
    if algorithm in WITH_STATE_VALUES:
        assert len(run.tables) == 2
        assert (run.tables[1] == run.tables[1][:, :1]).all()
        assert run.values(3) == run.tables[1][3, 0]
    else:
        assert len(run.tables) == 1
        with pytest.raises(
            ValueError, match=f"values needs an algorithm that learns values, got a run of '{algorithm}'"
        ):
            run.values(3)
    again = qtab.train(config=run.config, initial_q=run.tables[0] if len(run.tables) == 1 else run.tables)
    assert qtab.verify(again).equal


def test_predict_gives_the_most_likely_action_or_draws_one() -> None:
    run = qtab.train(CORRIDOR, seed=0)
    assert {run.predict(0)[0] for _ in range(50)} == {int(run.policy[0])}
    drawn = [run.predict(0, deterministic=False)[0] for _ in range(2000)]
    assert abs(np.mean(drawn) - probability_of_right(run)) < 4 * 0.5 / math.sqrt(2000)


@pytest.mark.parametrize("algorithm", PREFERENCES)
def test_other_explorations_are_refused(algorithm: Any) -> None:
    with pytest.raises(ValueError, match=rf"^exploration must be 'softmax' for algorithm '{algorithm}', got 'ucb'"):
        qtab.Config(algorithm=algorithm, exploration="ucb")
    with pytest.raises(
        ValueError, match=r"^epsilon applies to exploration 'epsilon_greedy', not to 'softmax', got 0.1"
    ):
        qtab.Config(algorithm=algorithm, epsilon=0.1)
    with pytest.raises(ValueError, match=r"^learning_rate_schedule must be"):
        qtab.Config(algorithm=algorithm, learning_rate_schedule="visits")
    with pytest.raises(ValueError, match=r"^learning_rate must not be negative, got -1"):
        qtab.Config(algorithm=algorithm, learning_rate=-1)
    if algorithm != "gradient_bandit":
        with pytest.raises(
            ValueError, match=r"^action_mask must be False for algorithm .* discretizer 'tiles', got True"
        ):
            qtab.Config(algorithm=algorithm, discretizer="tiles", action_mask=True)
    assert qtab.Config(algorithm=algorithm, learning_rate=4).learning_rate == 4


def test_options_of_other_algorithms_are_refused() -> None:
    with pytest.raises(ValueError, match=r"^baseline applies to algorithm 'gradient_bandit', not to 'reinforce'"):
        qtab.Config(algorithm="reinforce", baseline=True)
    with pytest.raises(ValueError, match=r"^value_learning_rate applies to algorithm"):
        qtab.Config(algorithm="reinforce", value_learning_rate=0.1)
    with pytest.raises(ValueError, match=r"^value_learning_rate must lie in"):
        qtab.Config(algorithm="actor_critic", value_learning_rate=1.5)
    with pytest.raises(TypeError, match=r"^baseline must be True or False, got 1"):
        qtab.Config(algorithm="gradient_bandit", baseline=1)  # type: ignore[arg-type]


def test_state_values_that_differ_between_columns_are_refused() -> None:
    tables = np.zeros((2, 1, 2))
    tables[1] = [[1.0, 2.0]]
    with pytest.raises(ValueError, match=r"^initial_q must have in its second table"):
        qtab.train(CORRIDOR, algorithm="actor_critic", initial_q=tables)


def test_a_preset_yields_to_an_algorithm_of_preferences() -> None:
    run = qtab.train("CliffWalking-v1", algorithm="actor_critic", **SHORT)
    assert run.config.exploration == "softmax"
    assert run.config.epsilon is None
    assert qtab.train(config=run.config, algorithm="sarsa").config.exploration == "softmax"
