"""Least-squares policy iteration: equal to policy iteration with exact features, and the chains of its article."""

import copy
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numpy.typing import NDArray

import qtab
from qtab.envs.book.random_mdp import random_mdp
from qtab.planning import Transitions, lspi, lstdq
from qtab.prediction import linear_geometry

GAMMA = 0.9
Array = NDArray[np.float64]
POLYNOMIALS = np.vander(np.arange(1.0, 5.0), 3, increasing=True)
"""1, s and s² for the states 1 to 4."""


def chain(states: int, rewarded: set[int]) -> qtab.TabularEnv:
    """Left and right, which go the other way with probability 0.1, and +1 for entering some states."""
    table = [
        [
            [
                (chance, after, float(after in rewarded), False)
                for chance, step in ((0.9, direction), (0.1, -direction))
                for after in [min(max(state + step, 0), states - 1)]
            ]
            for direction in (-1, 1)
        ]
        for state in range(states)
    ]
    return qtab.TabularEnv(table, np.full(states, 1 / states))


def named(found: Any, states: int) -> list[str]:
    """The policy of each iteration, such as "RRLL"."""
    every = np.arange(states)
    return ["".join("LR"[action] for action in found.actions(every, index)) for index in range(len(found.history))]


@pytest.fixture(scope="module")
def four() -> qtab.TabularEnv:
    return chain(4, {1, 2})


def plain_lstdq(batch: Transitions, features: Array, policy: Any, epsilon: float) -> Array:
    """A and b, transition by transition, as their definitions say."""
    d, k = features.shape[1], batch.n_actions

    def phi(state: int, action: int) -> Array:
        vector = np.zeros((k, d))
        vector[action] = features[state]
        return vector.ravel()

    A, b = epsilon * np.eye(k * d), np.zeros(k * d)  # noqa: N806
    for index in range(len(batch)):
        state, following = batch.observations[index], batch.next_observations[index]
        now = phi(state, batch.actions[index])
        after = (not batch.terminated[index]) * phi(following, policy[following])
        A += batch.weights[index] * np.outer(now, now - GAMMA * after)  # noqa: N806
        b += batch.weights[index] * batch.rewards[index] * now
    weights: NDArray[Any] = np.linalg.solve(A, b).reshape(k, d).T
    return weights


@pytest.mark.parametrize("epsilon", [0.0, 0.5])
@pytest.mark.parametrize(
    "features",
    [np.random.default_rng(2).standard_normal((6, 2)), np.eye(6), np.repeat(np.diag([1e6, 1e-3, 2.0]), 2, axis=0)],
    ids=["dense", "states", "groups"],
)
def test_lstdq_solves_the_equations_of_its_definition(features: Array, epsilon: float) -> None:
    env = gym.wrappers.TimeLimit(random_mdp(6, 2, 1, actions=3), 7)
    batch = Transitions.sample(env, 300, seed=4)
    assert batch.terminated.any()
    policy = np.array([2, 0, 1, 1, 0, 2])
    found = lstdq(batch, features, policy, GAMMA, epsilon=epsilon)
    np.testing.assert_allclose(found, plain_lstdq(batch, features, policy, epsilon), rtol=1e-9)
    by_function = lstdq(batch, lambda state: features[state], lambda state: int(policy[state]), GAMMA, epsilon=epsilon)
    assert np.array_equal(by_function, found)


def test_with_a_feature_for_each_state_it_is_policy_iteration(four: qtab.TabularEnv) -> None:
    for env, first in ((four, 1), (random_mdp(8, 3, 5, actions=3), 0), (gym.make("FrozenLake-v1").unwrapped, 2)):
        states = env.observation_space.n  # type: ignore[attr-defined]
        found = lspi(Transitions.of_table(env), np.eye(states), GAMMA, policy=first)
        every, exact = np.arange(states), list(qtab.planning.policy_iteration(env, GAMMA, policy=first))
        assert found.converged
        for index, step in enumerate(exact):
            values = found.q_values(every, index)[every, step.policy]
            np.testing.assert_allclose(values, step.values, atol=1e-9)
        best = qtab.optimum(env, discount=GAMMA, method="policy_iteration")
        np.testing.assert_allclose(found.q_values(every), best.q_values, atol=1e-9)
        assert qtab.policy_values(env, found, GAMMA).expected_return == pytest.approx(
            qtab.policy_values(env, best, GAMMA).expected_return
        )


def test_of_samples_it_is_policy_iteration_in_the_table_of_their_frequencies() -> None:
    batch = Transitions.sample(gym.wrappers.TimeLimit(random_mdp(5, 2, 7, actions=2), 20), 400, seed=1)
    outcomes = list(
        zip(batch.next_observations.tolist(), batch.rewards.tolist(), batch.terminated.tolist(), strict=True)
    )
    table: list[list[list[Any]]] = [[[] for _ in range(2)] for _ in range(5)]
    for state in range(5):
        for action in range(2):
            seen = np.flatnonzero((batch.observations == state) & (batch.actions == action))
            table[state][action] = [(1 / len(seen), *outcomes[index]) for index in seen]
    found = lspi(batch, np.eye(5), GAMMA)
    best = qtab.optimum(qtab.TabularEnv(table, np.full(5, 0.2)), discount=GAMMA, method="policy_iteration")
    np.testing.assert_allclose(found.q_values(np.arange(5)), best.q_values, atol=1e-9)


@pytest.mark.parametrize("samples", [None, 50])
def test_the_chain_of_four_states_ends_at_the_optimal_policy_of_the_article(
    four: qtab.TabularEnv, samples: int | None
) -> None:
    batch = Transitions.of_table(four) if samples is None else Transitions.sample(four, samples, seed=0)
    assert named(lspi(batch, POLYNOMIALS, GAMMA, policy=1), 4) == ["RLLL", "RRLL", "RRLL", "RRLL"]
    best = qtab.optimum(four, discount=GAMMA, method="policy_iteration")
    assert best.policy.tolist() == [1, 1, 0, 0]


def test_values_weighted_by_visits_alternate_between_two_bad_policies(four: qtab.TabularEnv) -> None:
    """Koller and Parr (2000): with the same features, the stationary distribution makes policy iteration oscillate."""
    policy, policies = np.ones(4, np.int64), []
    for _ in range(4):
        policies.append("".join("LR"[action] for action in policy))
        geometry = linear_geometry(four, policy, POLYNOMIALS, GAMMA)
        values = geometry.values_of(geometry.td_fixed_point)
        ahead = [
            [sum(p * (r + GAMMA * values[after]) for p, after, r, _ in four.P[state][action]) for action in range(2)]
            for state in range(4)
        ]
        policy = np.argmax(ahead, axis=1)
    assert policies == ["RRRR", "LLLL", "RRRR", "LLLL"]


def test_the_chain_of_twenty_states_is_solved_with_polynomials_of_degree_four() -> None:
    features = np.vander(np.arange(1.0, 21.0) / 2, 5, increasing=True)
    twenty = chain(20, {0, 19})
    for batch in (Transitions.of_table(twenty), Transitions.sample(twenty, 5_000, seed=0)):
        assert named(lspi(batch, features, GAMMA), 20)[-1] == "L" * 10 + "R" * 10


def test_the_chain_of_fifty_states_is_solved_from_one_random_walk() -> None:
    fifty = chain(50, {9, 40})
    states, centers = np.arange(50.0), np.linspace(0, 49, 10)
    gaussians = np.exp(-((states[:, None] - centers) ** 2) / (2 * 4.0**2))
    features = np.column_stack([np.ones(50), gaussians])
    found = lspi(Transitions.sample(fifty, 10_000, seed=0), features, GAMMA)
    policies = named(found, 50)
    assert found.converged
    assert len(policies) <= 8
    assert policies[-1] == "R" * 9 + "L" * 16 + "R" * 16 + "L" * 9


def test_the_recorded_episodes_of_a_run_are_its_transitions() -> None:
    run = qtab.train("MountainCar-v0", preset="article", seed=3, episodes=12, record=5)
    batch = Transitions.recorded(run)
    assert len(batch) == run.episode_lengths[-5:].sum()
    assert batch.rewards.sum() == run.episode_returns[-5:].sum()
    assert batch.n_actions == 3
    assert batch.observations.shape == (len(batch), 2)
    played = [action for recording in run.recordings for action in recording.actions]
    assert batch.actions.tolist() == played
    same_episode = ~np.isin(np.arange(1, len(batch)), np.cumsum(run.episode_lengths[-5:]))
    assert np.array_equal(batch.observations[1:][same_episode], batch.next_observations[:-1][same_episode])
    with pytest.raises(ValueError, match=r"run must have recorded episodes, as qtab\.train\(\.\.\., record=100\)"):
        Transitions.recorded(qtab.train("FrozenLake-v1", seed=0, episodes=2))


def test_the_last_step_before_a_time_limit_is_not_terminal() -> None:
    batch = Transitions.sample("MountainCar-v0", 450, lambda seen: [0.5, 0.0, 0.5], seed=0)
    assert not batch.terminated.any()
    assert set(batch.actions.tolist()) == {0, 2}
    assert batch.next_observations[199].tolist() != batch.observations[200].tolist()


def test_observations_of_several_integers_are_indices() -> None:
    env = gym.make("Blackjack-v1", sab=True)
    batch = Transitions.sample(env, 3000, seed=0)
    shape = (32, 11, 2)
    policy = np.zeros(shape, np.int64)
    policy[:18] = 1
    cells = np.ravel_multi_index(tuple(batch.observations.T), shape)
    flat = Transitions(
        cells, batch.actions, batch.rewards, np.ravel_multi_index(tuple(batch.next_observations.T), shape),
        batch.terminated,
    )  # fmt: skip
    features = np.random.default_rng(0).standard_normal((*shape, 4))
    found = lstdq(batch, features, policy, 1.0)
    assert np.array_equal(found, lstdq(flat, features.reshape(-1, 4), policy.ravel(), 1.0))


def test_a_cycle_of_policies_is_reported(four: qtab.TabularEnv) -> None:
    found = lspi(Transitions.sample(four, 10, seed=3), POLYNOMIALS[:, :2], GAMMA, max_iterations=8)
    assert named(found, 4) == ["RRRR", "LLLL"] * 4
    assert np.array_equal(found.history[-1], found.history[-3])
    assert not found.converged
    assert repr(found) == "<LeastSquaresPolicy of 2 features and 2 actions: 8 iterations, not converged>"
    assert repr(Transitions([0], [1], [0.0], [1], [False])) == "<1 transition, 2 actions>"


def allowed(state: Any) -> Any:
    """The mask of a state of FrozenLake: no step to the left in the first column, and none up in the first row."""
    return [state % 4 > 0, True, True, state > 3]


def test_masked_actions_are_never_chosen() -> None:
    lake = gym.make("FrozenLake-v1", is_slippery=False).unwrapped
    masked: Any = copy.deepcopy(lake)
    for state in range(16):  # the same task, in which the masked actions are the worst ones
        for action in np.flatnonzero(~np.array(allowed(state))):
            masked.P[state][int(action)] = [(1.0, state, -10.0, False)]
    found = lspi(Transitions.of_table(lake), np.eye(16), GAMMA, action_mask=allowed)
    best = qtab.optimum(masked, discount=GAMMA, method="policy_iteration")
    for iteration in range(len(found.history)):
        assert all(allowed(state)[action] for state, action in enumerate(found.actions(np.arange(16), iteration)))
    assert found(0) == best.policy[0]
    every = np.flatnonzero(np.array([allowed(state) for state in range(16)]))
    np.testing.assert_allclose(found.q_values(np.arange(16)).ravel()[every], best.q_values.ravel()[every], atol=1e-9)
    assert {lspi(Transitions.of_table(lake), np.eye(16), GAMMA)(state) for state in (5, 7)} == {0}


def test_recorded_episodes_with_masks_need_them_again() -> None:
    run = qtab.train("FrozenLake-v1", seed=0, episodes=40, record=40, action_mask=allowed, epsilon=1.0)
    batch = Transitions.recorded(run)
    with pytest.raises(ValueError, match=r"action_mask must be a function .* since the recorded run had action masks"):
        lspi(batch, np.eye(16), GAMMA, epsilon=0.01)
    found = lspi(batch, np.eye(16), GAMMA, epsilon=0.01, action_mask=allowed)
    assert all(allowed(state)[found(state)] for state in range(16))
    for wrong, error in ((True, TypeError), (lambda state: [True, True], ValueError)):
        with pytest.raises(error, match="action_mask must"):
            lspi(batch, np.eye(16), GAMMA, epsilon=0.01, action_mask=wrong)  # type: ignore[arg-type]


HALF = Transitions([0, 1, 0], [0, 0, 1], [1.0, 0.0, 0.0], [1, 0, 1], [False, False, False])


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (
            lambda: lspi(HALF, np.eye(2)),
            ValueError,
            "A is singular: .* leave open the weights of features 1 of action 1",
        ),
        (
            lambda: lspi(HALF, np.ones((2, 2))),
            ValueError,
            "leave open the weights of features 0, 1 of action 0; set epsilon above 0, or",
        ),
        (
            lambda: lspi(Transitions([0], [0], [1.0], [0], [True], n_actions=2), [[1.0]]),
            ValueError,
            "the weights of action 1, which is never taken",
        ),
        (
            lambda: lstdq(Transitions([0], [0], [1.0], [1], [False], 2), [[1.0], [3.0]], 0, 0.9, epsilon=1.7),
            ValueError,
            "the transitions leave open all weights; set epsilon to a value other than 1.7, or use more transitions",
        ),
        (lambda: lspi(HALF, np.eye(2), epsilon=0.1).q_values(0), ValueError, "observations must hold at least 1"),
        (
            lambda: lspi(Transitions([0], [0], [1.0], [0], [True], weights=[1e50]), [[1e150]]),
            ValueError,
            "features and rewards must be smaller",
        ),
        (
            lambda: lspi(HALF, [[1.0]]),
            ValueError,
            "features must have an item for each observation, got 1 and observation",
        ),
        (lambda: lspi(HALF, [1.0, 2.0]), ValueError, r"features must have the shape \(states, d\), got \(2,\)"),
        (lambda: lspi(HALF, lambda seen: [1.0] * (seen + 1)), ValueError, "features must return as many numbers each"),
        (lambda: lspi(HALF, lambda seen: 1.0), ValueError, r"features must return a vector \(d,\)"),
        (lambda: lspi(HALF, np.eye(2), policy=2), ValueError, "policy must be actions from 0 to 1, got 2"),
        (lambda: lspi(HALF, np.eye(2), policy=[0.5, 1.0]), TypeError, "policy must be the number of an action"),
        (lambda: lspi(HALF, np.eye(2), discount=2), ValueError, r"discount must lie in \[0, 1\]"),
        (lambda: lspi(HALF, np.eye(2), epsilon=-1.0), ValueError, "epsilon must be at least 0, got -1"),
        (lambda: lspi(HALF, np.eye(2), tolerance=0.0), ValueError, "tolerance must be above 0, got 0"),
        (lambda: lspi([1, 2], np.eye(2)), TypeError, "transitions must be a Transitions, got"),  # type: ignore[arg-type]
        (lambda: Transitions([], [], [], [], []), ValueError, "observations must hold at least 1"),
        (lambda: Transitions([0], [0.5], [1], [0], [True]), TypeError, "actions must hold integers"),
        (lambda: Transitions([0], [0], [1], [0], [1]), TypeError, "terminated must hold booleans"),
        (lambda: Transitions([0], [0], [1, 2], [0], [True]), ValueError, r"rewards must have the shape \(1,\)"),
        (lambda: Transitions([0], [3], [1], [0], [True], 2), ValueError, "actions must be numbers from 0 to 1, got 3"),
        (lambda: Transitions(["a"], [0], [1], ["b"], [True]), TypeError, "observations must be an array of numbers"),
        (lambda: Transitions.sample("FrozenLake-v1", 5, "greedy"), ValueError, "policy must be 'random' or a policy"),
        (lambda: Transitions.sample("Pendulum-v1", 5), ValueError, r"env must have discrete actions, got Box\("),
        (lambda: Transitions.of_table("MountainCar-v0"), ValueError, "env must have a transition table"),
    ],
)
def test_what_cannot_be_solved_is_refused_by_name(call: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        call()
