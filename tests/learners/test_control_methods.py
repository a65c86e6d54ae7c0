"""What the control methods of the book learn, where it is known."""

from typing import Any

import numpy as np
import pytest

import qtab

BLACKJACK: dict[str, Any] = {
    "env_kwargs": {"sab": True},
    "discount": 1.0,
    "initial_q": 0.0,
    "max_episode_steps": 100,
    "episodes": 300_000,
}
STICK, HIT = range(2)
CLEAR = {(20, 10): STICK, (19, 5): STICK, (18, 8): STICK, (11, 6): HIT, (8, 10): HIT, (14, 10): HIT}
"""What to do with a sum against a dealer's card, without a usable ace, where one action is much better."""


@pytest.mark.parametrize(
    "settings",
    [
        {"algorithm": "monte_carlo", "epsilon": 0.2, "epsilon_schedule": "constant"},
        {"algorithm": "monte_carlo_es"},
        {"algorithm": "off_policy_monte_carlo", "epsilon": 0.5, "epsilon_schedule": "constant"},
    ],
    ids=lambda settings: str(settings["algorithm"]),
)
def test_monte_carlo_control_learns_to_play_blackjack(settings: Any) -> None:
    run = qtab.train("Blackjack-v1", seed=0, **BLACKJACK, **settings)
    played = {hand: run.predict((*hand, 0))[0] for hand in CLEAR}
    assert played == CLEAR
    # Sticking on 20 against a 10 is worth 0.4350 by dynamic programming. 300,000 hands give it to within 0.02.
    assert run.q_table[20, 10, 0, STICK] == pytest.approx(0.435, abs=0.02)


def ring(rewards: tuple[float, ...]) -> qtab.TabularEnv:
    """States in a circle: action 0 stays for nothing, action 1 goes on for the state's reward."""
    count = len(rewards)
    table = {
        state: {0: [(1.0, state, 0.0, False)], 1: [(1.0, (state + 1) % count, reward, False)]}
        for state, reward in enumerate(rewards)
    }
    return qtab.TabularEnv(table, [1.0] + [0.0] * (count - 1))


@pytest.mark.parametrize("algorithm", ["differential_sarsa", "differential_q_learning"])
def test_differential_values_are_those_of_the_average_reward(algorithm: Any) -> None:
    settings: dict[str, Any] = {"algorithm": algorithm, "episodes": 1, "max_episode_steps": 60_000, "initial_q": 0.0}
    run = qtab.train(ring((1.0, 0.0, 5.0)), seed=0, epsilon=0.1, learning_rate=0.05, **settings)
    assert run.q_table.argmax(axis=1).tolist() == [1, 1, 1]
    # Without exploration the average reward is 2, and v(s) - v(s + 1) = R - 2.
    if algorithm == "differential_q_learning":
        values = run.q_table.max(axis=1)
        assert values[0] - values[1] == pytest.approx(-1.0, abs=0.05)
        assert values[1] - values[2] == pytest.approx(-2.0, abs=0.05)


def test_an_episode_that_ends_goes_on_with_the_next_one() -> None:
    # Both actions end the episode: after one step with a reward of 1, or after two with a reward of 3 in all.
    table = {
        0: {0: [(1.0, 2, 1.0, True)], 1: [(1.0, 1, 0.0, False)]},
        1: {action: [(1.0, 2, 3.0, True)] for action in range(2)},
        2: {action: [(1.0, 2, 0.0, True)] for action in range(2)},
    }
    env = qtab.TabularEnv(table, [1.0, 0.0, 0.0])
    run = qtab.train(env, seed=0, algorithm="differential_q_learning", episodes=20_000, epsilon=0.3, initial_q=0.0)
    # 1.5 a step by the long way, 1 by the short one: Q(0, 1) - Q(0, 0) = (0 - 1.5) + (3 - 1.5) - (1 - 1.5).
    assert run.q_table[0, 1] - run.q_table[0, 0] == pytest.approx(0.5, abs=0.1)


def slippery() -> qtab.TabularEnv:
    """One state: the risky action pays 4 once in four times, the safe one 0.8."""
    risky = [(0.25, 1, 4.0, True), (0.75, 1, 0.0, True)]
    table = {0: {0: risky, 1: [(1.0, 1, 0.8, True)]}, 1: {action: [(1.0, 1, 0.0, True)] for action in range(2)}}
    return qtab.TabularEnv(table, [1.0, 0.0])


def test_a_stochastic_model_plans_with_all_that_followed() -> None:
    settings: dict[str, Any] = {"algorithm": "dyna_q", "episodes": 400, "epsilon": 0.5, "planning_steps": 50}
    settings |= {"learning_rate": 0.01, "initial_q": 0.0}
    errors = {
        model: np.mean(
            [abs(qtab.train(slippery(), seed=seed, model=model, **settings).q_table[0, 0] - 1) for seed in range(20)]
        )
        for model in ("deterministic", "stochastic")
    }
    assert errors["stochastic"] < 0.2 < errors["deterministic"]


@pytest.mark.parametrize("env", ["qtab/MaximizationBias-v0", "qtab/KArmedBandit-v0", "Blackjack-v1"])
def test_a_stochastic_model_of_many_outcomes_draws_those_of_the_reference(env: str) -> None:
    settings: dict[str, Any] = {"algorithm": "dyna_q", "model": "stochastic", "episodes": 150, "planning_steps": 4}
    run = qtab.train(env, seed=3, epsilon=0.5, **settings)
    assert qtab.verify(run).equal


def test_a_count_bonus_falls_with_the_visits_and_is_no_part_of_the_returns() -> None:
    table = {state: {action: [(1.0, 1, float(action), True)] for action in range(2)} for state in range(2)}
    env = qtab.TabularEnv(table, [1.0, 0.0])
    settings: dict[str, Any] = {"learning_rate": 1.0, "epsilon": 1.0, "episodes": 30, "seed": 0}
    run = qtab.train(env, **settings, count_bonus=3.0, visits=True)
    assert run.visits is not None
    counts = run.visits[0]
    assert counts.min() > 5
    assert run.q_table[0].tolist() == [action + 3.0 / np.sqrt(count) for action, count in enumerate(counts)]
    assert set(run.episode_returns) == {0.0, 1.0}
    assert qtab.verify(run, env=env).equal


def test_tree_backup_of_q_sigma_is_tree_backup() -> None:
    settings: dict[str, Any] = {"episodes": 20, "seed": 1, "epsilon": 0.3, "n_steps": 3}
    sigma = qtab.train("CliffWalking-v1", algorithm="n_step_q_sigma", sigma=0.0, **settings)
    tree = qtab.train("CliffWalking-v1", algorithm="n_step_tree_backup", **settings)
    assert sigma.tables.tobytes() == tree.tables.tobytes()


def test_the_degree_of_sampling_does_not_matter_for_one_step() -> None:
    settings: dict[str, Any] = {"episodes": 5, "seed": 1, "epsilon": 0.3, "n_steps": 1, "algorithm": "n_step_q_sigma"}
    none, full = (qtab.train("CliffWalking-v1", sigma=sigma, **settings) for sigma in (0.0, 1.0))
    assert none.tables.tobytes() == full.tables.tobytes()


def test_prioritized_sweeping_solves_a_maze_in_few_updates() -> None:
    settings: dict[str, Any] = {
        "learning_rate": 1.0,
        "discount": 0.95,
        "epsilon": 0.1,
        "initial_q": 0.0,
        "ties": "random",
    }
    run = qtab.train("qtab/DynaMaze-v0", algorithm="prioritized_sweeping", episodes=6, seed=0, **settings)
    assert run.episode_lengths[-3:].max() <= 30
