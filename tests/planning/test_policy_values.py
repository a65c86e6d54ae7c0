"""The exact values of given policies: against the book's, against NumPy's linear solver, and against episodes."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numpy.typing import NDArray

import qtab


def random_walk(states: int) -> qtab.TabularEnv:
    """The random walk of Example 6.2: a reward of 1 at the right end."""

    def step(state: int, shift: int) -> tuple[float, int, float, bool]:
        end = not 0 <= state + shift < states
        return 1.0, state if end else state + shift, float(end and shift > 0), end

    table = [[[step(state, -1)], [step(state, 1)]] for state in range(states)]
    return qtab.TabularEnv(table, [float(state == states // 2) for state in range(states)])


def solved(env: Any, policy: NDArray[np.float64], discount: float) -> NDArray[np.float64]:
    """The values by NumPy's solver of linear equations."""
    count = len(env.P)
    chain, rewards = np.zeros((count, count)), np.zeros(count)
    for state in range(count):
        for action, transitions in env.P[state].items():
            for probability, next_state, reward, terminated in transitions:
                weight = policy[state, action] * probability
                rewards[state] += weight * reward
                chain[state, next_state] += 0.0 if terminated else weight * discount
    values: NDArray[Any] = np.linalg.solve(np.eye(count) - chain, rewards)
    return values


def test_the_random_walk_has_the_books_values() -> None:
    found = qtab.policy_values(random_walk(5), "random")
    assert np.abs(found.values - np.arange(1, 6) / 6).max() <= found.error < 1e-13
    np.testing.assert_allclose(found.state_distribution, np.array([1, 2, 3, 2, 1]) / 9, atol=1e-13)
    assert found.expected_return == pytest.approx(0.5, abs=1e-13)


@pytest.mark.parametrize("discount", [0.9, 1.0])
def test_the_values_solve_the_bellman_equation(discount: float) -> None:
    env: Any = gym.make("FrozenLake-v1").unwrapped
    policy = np.random.default_rng(0).dirichlet(np.ones(4), size=16)
    found = qtab.policy_values(env, policy, discount)
    assert np.abs(found.values - solved(env, policy, discount)).max() < found.error + 1e-13
    np.testing.assert_allclose((found.q_values * policy).sum(axis=1), found.values, atol=1e-13)


def test_blackjack_has_the_value_of_the_book() -> None:
    # Example 5.4 gives -0.27726, the mean of 10^8 episodes, whose standard error is 1e-4.
    values = qtab.policy_values("Blackjack-v1", lambda hand: int(hand[0] < 20), env_kwargs={"sab": True}).values
    assert values[13, 2, 1] == pytest.approx(-0.27726, abs=2e-4)


def test_runs_and_optima_are_policies() -> None:
    best = qtab.optimum("FrozenLake-v1", method="policy_iteration")
    found = qtab.policy_values("FrozenLake-v1", best)
    np.testing.assert_allclose(found.values, best.values, atol=1e-10)
    run = qtab.train("FrozenLake-v1", seed=0, episodes=200)
    greedy = qtab.policy_values("FrozenLake-v1", run, 0.99)
    assert np.array_equal(greedy.values, qtab.policy_values("FrozenLake-v1", run.policy, 0.99).values)


@pytest.mark.parametrize(
    ("policy", "error", "message"),
    [
        (np.zeros((16, 3)), ValueError, r"shape \(16,\) of actions or \(16, 4\) of probabilities, got \(16, 3\)"),
        (np.full((16, 4), 0.3), ValueError, "policy must sum to 1 in every state, got 1.2 in row 0"),
        (np.tile([1.5, -0.5, 0.0, 0.0], (16, 1)), ValueError, "policy must hold probabilities of at least 0"),
        (np.full((16, 4), np.nan), ValueError, "policy must hold probabilities of at least 0"),
        (np.full(16, 4), ValueError, "policy must hold actions from 0 to 3, got 4"),
        (np.zeros(16), TypeError, "policy must hold integers if it has an action for each state"),
        ("randm", ValueError, "did you mean 'random'"),
        (None, TypeError, "policy must be an array of actions or of probabilities"),
        (lambda state: [0.5, 0.5], ValueError, "policy must return the number of an action or 4 probabilities"),
    ],
)
def test_what_is_no_policy_is_refused_by_name(policy: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        qtab.policy_values("FrozenLake-v1", policy)


def test_an_endless_policy_needs_a_discount() -> None:
    up = np.zeros(48, np.int64)
    with pytest.raises(ValueError, match="policy must end every episode: from state 0 no episode ends"):
        qtab.policy_values("CliffWalking-v1", up)
    assert qtab.policy_values("CliffWalking-v1", up, 0.5).values[0] == pytest.approx(-2.0)


def test_the_message_names_the_sweeps_that_were_made() -> None:
    table = {0: {0: [(1.0, 0, -1.0, False), (1e-17, 0, -1.0, True)]}}
    with pytest.raises(ValueError, match="the values still change after 1000 sweeps; a discount below 1 helps"):
        qtab.policy_values(qtab.TabularEnv(table, [1.0]), "random")


def test_an_environment_without_a_table_is_refused() -> None:
    with pytest.raises(ValueError, match="env must have a transition table"):
        qtab.policy_values("MountainCar-v0", "random")


def test_probabilities_of_a_function_must_sum_to_1_in_float64() -> None:
    thirds = np.array([1 / 3, 1 / 3, 1 / 3, 0], np.float32)
    assert thirds.sum() == 1
    with pytest.raises(ValueError, match="must sum to 1 in every state, got 1 in row 0"):
        qtab.policy_values("FrozenLake-v1", lambda observation: thirds)
