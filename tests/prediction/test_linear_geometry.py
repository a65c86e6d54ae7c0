"""The geometry of linear values: the book's numbers, the minima of the errors, the distribution, what is refused."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numpy.typing import NDArray

import qtab
from qtab.envs.book.random_mdp import random_mdp
from qtab.prediction import LinearGeometry, linear_geometry, state_aggregation

OBJECTIVES: tuple[Any, ...] = ("value_error", "bellman_error", "projected_bellman_error", "td_error")


def chain(*rows: list[tuple[float, int, float, bool]], start: list[float]) -> qtab.TabularEnv:
    """A Markov reward process: one action."""
    return qtab.TabularEnv([[row] for row in rows], start)


def baird() -> qtab.TabularEnv:
    dashed = [(1 / 6, state, 0.0, False) for state in range(6)]
    return qtab.TabularEnv([[dashed, [(1.0, 6, 0.0, False)]] for _ in range(7)], np.full(7, 1 / 7))


def baird_features() -> NDArray[np.float64]:
    features = np.zeros((7, 8))
    features[:6, :6] = 2.0 * np.eye(6)
    features[:6, 7], features[6, 6], features[6, 7] = 1.0, 1.0, 2.0
    return features


def random_geometry(seed: int = 0, **arguments: Any) -> LinearGeometry:
    rng = np.random.default_rng(seed)
    policy, behavior = rng.dirichlet(np.ones(3), size=(2, 12))
    env = random_mdp(12, 3, seed, actions=3)
    return linear_geometry(env, policy, rng.standard_normal((12, 4)), 0.9, behavior=behavior, **arguments)


def test_the_errors_of_the_a_split_example_are_minimal_at_the_books_values() -> None:
    """Example 11.2: the naive residual gradient algorithm finds 3/4 and 1/4 instead of 1 and 0."""
    env = chain(
        *([(0.5, 1, 0.0, False), (0.5, 2, 0.0, False)], [(1.0, 1, 1.0, True)], [(1.0, 2, 0.0, True)]),
        start=[1.0, 0.0, 0.0],
    )
    found = linear_geometry(env, "random")
    np.testing.assert_allclose(found.distribution, [0.5, 0.25, 0.25], atol=1e-15)
    np.testing.assert_allclose(found.minimizer("td_error"), [0.5, 0.75, 0.25], atol=1e-14)
    for objective in OBJECTIVES[:3]:
        np.testing.assert_allclose(found.minimizer(objective), [0.5, 1.0, 0.0], atol=1e-14)


def test_the_bellman_error_of_the_a_presplit_example_is_minimal_at_the_books_values() -> None:
    """Example 11.3: two states that look alike; also the residual gradient algorithm is wrong."""
    env = chain(
        *([(1.0, 2, 0.0, False)], [(1.0, 3, 0.0, False)], [(1.0, 2, 1.0, True)], [(1.0, 3, 0.0, True)]),
        start=[0.5, 0.5, 0.0, 0.0],
    )
    found = linear_geometry(env, "random", np.array([0, 0, 1, 2]))
    np.testing.assert_allclose(found.minimizer("bellman_error"), [0.5, 0.75, 0.25], atol=1e-14)
    np.testing.assert_allclose(found.td_fixed_point, [0.5, 1.0, 0.0], atol=1e-14)


def test_processes_with_the_same_data_have_different_bellman_errors() -> None:
    """Example 11.4: with a value of zero everywhere, BE is 0 in the first process and 2/3 in the second."""
    to_a, to_b = (0.5, 0, 1.0, False), (0.5, 1, -1.0, False)
    first = linear_geometry(chain([(1.0, 1, 0.0, False)], [to_a, to_b], start=[1.0, 0.0]), "random", discount=0.9)
    either = [(0.5, 1, 0.0, False), (0.5, 2, 0.0, False)]
    hidden = [(probability, state, -1.0, False) for probability, state, _, _ in either]
    second = linear_geometry(
        chain(either, [(1.0, 0, 1.0, False)], hidden, start=[1.0, 0.0, 0.0]), "random", np.array([0, 1, 1]), 0.9
    )
    np.testing.assert_allclose(first.distribution, [1 / 3, 2 / 3])
    np.testing.assert_allclose(second.distribution, [1 / 3] * 3)
    assert first.bellman_error([0.0, 0.0]) == 0.0
    assert second.bellman_error([0.0, 0.0]) == pytest.approx(2 / 3)
    # What depends on the data alone is the same.
    for objective in ("td_error", "projected_bellman_error"):
        np.testing.assert_allclose(second.minimizer(objective), first.minimizer(objective), atol=1e-12)


@pytest.mark.parametrize("trace_decay", [0.0, 0.6])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_no_other_weights_have_a_smaller_error(objective: Any, trace_decay: float) -> None:
    found = random_geometry(3, trace_decay=trace_decay)
    error = getattr(found, objective)
    best = found.minimizer(objective)
    around = best + 1e-3 * np.random.default_rng(0).standard_normal((50, 4))
    assert (error(around) > error(best)).all()
    assert error(around).shape == (50,)
    # Quadratic, with the gradient zero: half of the way costs a quarter.
    np.testing.assert_allclose(error((around + best) / 2) - error(best), (error(around) - error(best)) / 4, rtol=1e-4)


def test_the_projection_splits_values_into_what_weights_can_represent_and_the_rest() -> None:
    found = random_geometry(5)
    projection = found.projection
    np.testing.assert_allclose(projection @ projection, projection, atol=1e-13)
    np.testing.assert_allclose(projection @ found.features, found.features, atol=1e-13)
    np.testing.assert_allclose(projection @ found.values, found.values_of(found.minimizer("value_error")), atol=1e-13)
    w = np.arange(4.0)
    rest = found.bellman_errors(w) @ (np.eye(12) - projection).T
    total = found.projected_bellman_error(w) + (found.distribution * rest**2).sum()
    assert total == pytest.approx(found.bellman_error(w))


def test_the_td_fixed_point_has_no_projected_bellman_error_and_a_bounded_value_error() -> None:
    env = gym.make("qtab/RandomWalk-v0", states=1000, reach=100)
    found = linear_geometry(env, "random", state_aggregation(1000, 100), 0.95)
    w = found.td_fixed_point
    assert found.projected_bellman_error(w) < 1e-20
    np.testing.assert_allclose(found.A @ w, found.b, atol=1e-14)
    least = found.value_error(found.minimizer("value_error"))
    assert least < found.value_error(w) <= least / (1 - 0.95)  # equation 9.14


def test_with_full_traces_td_converges_to_the_least_value_error() -> None:
    found = random_geometry(1, trace_decay=1.0)
    np.testing.assert_allclose(found.td_fixed_point, found.minimizer("value_error"), rtol=1e-9)
    np.testing.assert_allclose(found.bellman_error(np.ones(4)), found.value_error(np.ones(4)))


def test_the_errors_are_those_of_sampled_transitions() -> None:
    found = random_geometry(2)
    rng, w, count = np.random.default_rng(1), np.array([1.0, -1.0, 0.5, 2.0]), 200_000
    chain = found.chain
    weights = found.distribution[chain.state] * chain.probability
    drawn = rng.choice(len(weights), count, p=weights / weights.sum())
    values = found.values_of(w)
    following = np.where(chain.continues[drawn], values[chain.next_state[drawn]], 0.0)
    errors = chain.reward[drawn] + 0.9 * following - values[chain.state[drawn]]
    assert (errors**2).mean() == pytest.approx(float(found.td_error(w)), rel=0.02)


def test_td_approaches_its_fixed_point() -> None:
    env = gym.make("qtab/RandomWalk-v0", states=12)
    rows = state_aggregation(12, 4)
    found = linear_geometry(env, "random", rows)
    estimates = qtab.estimate_values(
        env,
        "random",
        learning_rate=0.02,
        min_learning_rate=0.0,
        features=rows,
        episodes=20_000,
        record=20_000,
        seeds=20,
        progress=False,
    )
    last = estimates.weights[:, -1]
    standard_error = last.std(axis=0, ddof=1) / np.sqrt(20)
    assert standard_error.max() < 0.005
    assert (np.abs(last.mean(axis=0) - found.td_fixed_point) < 3 * standard_error).all()
    assert np.abs(found.td_fixed_point - found.minimizer("value_error")).max() > 0.05


def test_the_distribution_is_the_fraction_of_time_steps() -> None:
    for policy in ("random", np.tile([0.1, 0.4, 0.4, 0.1], (16, 1))):
        exact = qtab.policy_values("FrozenLake-v1", policy)
        found = linear_geometry("FrozenLake-v1", policy)
        np.testing.assert_allclose(found.distribution, exact.state_distribution, atol=1e-13)
        np.testing.assert_allclose(found.values, exact.values, atol=0)


def test_the_distribution_of_an_endless_process_is_stationary_and_leaves_out_passing_states() -> None:
    # The chain starts in state 0 and never returns to it.
    env = chain(
        *([(1.0, 1, 0.0, False)], [(0.5, 1, 1.0, False), (0.5, 2, 0.0, False)], [(1.0, 1, 0.0, False)]),
        start=[1.0, 0.0, 0.0],
    )
    np.testing.assert_allclose(linear_geometry(env, "random", discount=0.5).distribution, [0.0, 2 / 3, 1 / 3])
    apart = chain(
        *([(0.5, 1, 0.0, False), (0.5, 2, 0.0, False)], [(1.0, 1, 0.0, False)], [(1.0, 2, 0.0, False)]),
        start=[1.0, 0, 0],
    )
    with pytest.raises(ValueError, match=r"distribution must be given .*: no steps lead from state 1 to state 2"):
        linear_geometry(apart, "random", discount=0.5)
    given = linear_geometry(apart, "random", discount=0.5, distribution=[0.2, 0.3, 0.5])
    assert given.distribution.tolist() == [0.2, 0.3, 0.5]


def test_bairds_counterexample_names_its_linearly_dependent_features() -> None:
    found = linear_geometry(baird(), np.ones(7, int), baird_features(), 0.99, behavior=np.tile([6 / 7, 1 / 7], (7, 1)))
    np.testing.assert_allclose(found.distribution, 1 / 7)
    w = np.array([1.0, 1, 1, 1, 1, 1, 10, 1])
    assert found.value_error(w) == pytest.approx((6 * 9 + 144) / 7)
    # Seven independent feature vectors represent all values: nothing is lost in the projection.
    assert found.projected_bellman_error(w) == pytest.approx(float(found.bellman_error(w)))
    with pytest.raises(ValueError, match="features 0, 1, 2, 3, 4, 5, 6, 7 are linearly dependent"):
        _ = found.td_fixed_point
    partly = linear_geometry(
        "qtab/RandomWalk-v0", "random", np.stack([np.arange(19.0), np.ones(19) * 3, np.ones(19)], 1)
    )
    for objective in OBJECTIVES:
        with pytest.raises(ValueError, match="features 1, 2 are linearly dependent"):
            partly.minimizer(objective)


def test_features_of_states_that_are_never_visited_are_named() -> None:
    found = linear_geometry("FrozenLake-v1", "random")
    with pytest.raises(ValueError, match="features 5, 7, 11, 12, 15 are zero there"):
        _ = found.td_fixed_point  # the holes and the goal, where episodes end


def test_a_singular_update_is_refused() -> None:
    """The values w and 2 w of two states, the first leading to the second (section 11.2): A is zero with γ = 1/2."""
    env = chain([(1.0, 1, 1.0, False)], [(1.0, 1, 0.0, True)], start=[1.0, 0.0])
    features = np.array([[1.0], [2.0]])
    with pytest.raises(ValueError, match="must have one fixed point: with this distribution, A is singular"):
        _ = linear_geometry(env, "random", features, 0.5, distribution=[1.0, 0.0]).td_fixed_point


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (
            {"features": np.ones((18, 2))},
            ValueError,
            r"features must have .* 19 states, in an array of shape \(19, d\), got \(18, 2\)",
        ),
        ({"features": np.full((19, 1), np.nan)}, ValueError, "features must be finite"),
        ({"features": [["a"]] * 19}, TypeError, "features must be None or an array of integers"),
        (
            {"features": np.arange(19) // 18 * 10**6},
            MemoryError,
            "numbers for 1,000,001 features would take .* TiB, more than",
        ),
        (
            {"features": np.arange(19) // 18 * (2**31 - 1)},
            MemoryError,
            "^a matrix of 19 x 2,147,483,648 numbers for 2,147,483,648 features would take 304 GiB, more than half",
        ),
        ({"features": [10**30] * 19}, ValueError, "features must hold numbers from 0 to 2147483647, got 10{30}$"),
        ({"features": [-(10**30)] * 19}, ValueError, "features must hold numbers from 0 to 2147483647, got -10{30}$"),
        ({"distribution": np.full(19, 0.1)}, ValueError, "distribution must sum to 1, got 1.9"),
        ({"distribution": np.ones(3)}, ValueError, r"distribution must have the shape \(19,\), got \(3,\)"),
        ({"distribution": np.r_[-1.0, 2.0, np.zeros(17)]}, ValueError, "distribution must hold probabilities"),
        ({"distribution": np.full(19, 1 / 19), "behavior": "random"}, ValueError, "distribution must be None"),
        ({"behavior": np.ones((19, 2))}, ValueError, "behavior must sum to 1 in every state, got 2 in row 0"),
        ({"policy": np.ones((19, 2))}, ValueError, "policy must sum to 1"),
        ({"discount": 1.5}, ValueError, r"discount must lie in \[0, 1\]"),
        ({"trace_decay": -1}, ValueError, r"trace_decay must lie in \[0, 1\]"),
        ({"env": "Blackjack-v1"}, ValueError, "env must show its whole state"),
        ({"env": "CartPole-v1"}, ValueError, "env must have a transition table"),
    ],
)
def test_bad_arguments_are_refused(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        linear_geometry(**{"env": "qtab/RandomWalk-v0", "policy": "random", **arguments})


def test_a_function_gives_the_feature_vector_of_each_state() -> None:
    found = linear_geometry("FrozenLake-v1", "random", lambda state: (1, state // 4, state % 4), 0.9)
    assert found.features.tolist() == [[1, state // 4, state % 4] for state in range(16)]
    with pytest.raises(TypeError, match="features must return a vector of numbers, got None for the observation 0"):
        linear_geometry("FrozenLake-v1", "random", lambda _: None)


def test_bad_weights_and_names_are_refused() -> None:
    found = random_geometry()
    with pytest.raises(ValueError, match=r"weights must have 4 numbers, one for each feature, got shape \(3,\)"):
        found.value_error([1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match=r"objective must be one of 'value_error', .*, got 'VE'"):
        found.minimizer("VE")  # type: ignore[arg-type]
    assert repr(found) == "<LinearGeometry of TabularEnv: 12 states, 4 features, discount 0.9, λ = 0>"
    assert "features" in found._repr_html_()
