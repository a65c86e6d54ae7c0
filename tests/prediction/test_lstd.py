"""LSTD: equal to the book's box in a few lines of NumPy, to solving its equations, and near the fixed point of TD."""

from itertools import islice
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numpy.typing import NDArray

import qtab
from qtab.envs.book.random_mdp import random_mdp
from qtab.prediction import LSTD, linear_geometry
from qtab.prediction.reference.off_policy import transitions

GAMMA, EPSILON = 0.9, 0.5
FEATURES = np.random.default_rng(3).standard_normal((6, 3))
Array = NDArray[np.float64]


def steps(count: int) -> list[Any]:
    env = random_mdp(6, 2, 1, actions=2)
    policy = np.tile([0.3, 0.7], (6, 1))
    return list(islice(transitions(env, policy, policy, 5), count))


def learned(count: int, **arguments: Any) -> LSTD:
    found = LSTD(3, GAMMA, epsilon=EPSILON, **arguments)
    found.start_episode()
    for step in steps(count):
        found.update(FEATURES[step.state], step.reward, FEATURES[step.next_state], terminated=step.terminated)
        if step.over:
            found.start_episode()
    return found


def sums(count: int, trace_decay: float) -> tuple[Array, Array]:
    """A and b, as their definitions say."""
    A, b, z = EPSILON * np.eye(3), np.zeros(3), np.zeros(3)  # noqa: N806
    for step in steps(count):
        x, next_x = FEATURES[step.state], (not step.terminated) * FEATURES[step.next_state]
        z = GAMMA * trace_decay * z + x
        A += np.outer(z, x - GAMMA * next_x)  # noqa: N806
        b += step.reward * z
        z = (not step.over) * z
    return A, b


def test_it_equals_the_books_box_to_the_bit() -> None:
    def product(matrix: Array, vector: Array) -> Array:
        total: Array = matrix[:, 0] * vector[0] + matrix[:, 1] * vector[1] + matrix[:, 2] * vector[2]
        return total

    inverse, b = np.eye(3) / EPSILON, np.zeros(3)
    for step in steps(500):
        x, next_x = FEATURES[step.state], (not step.terminated) * FEATURES[step.next_state]
        v = product(inverse.T, x - GAMMA * next_x)
        inverse = inverse - np.outer(product(inverse, x), v) / (1.0 + (v[0] * x[0] + v[1] * x[1] + v[2] * x[2]))
        b = b + step.reward * x
    found = learned(500)
    assert found.weights.tobytes() == product(inverse, b).tobytes()
    assert found.b.tobytes() == b.tobytes()


@pytest.mark.parametrize("trace_decay", [0.0, 0.6, 1.0])
def test_the_recursion_and_the_solution_of_the_equations_agree(trace_decay: float) -> None:
    A, b = sums(500, trace_decay)  # noqa: N806
    expected = np.linalg.solve(A, b)
    for recursive in (True, False):
        found = learned(500, trace_decay=trace_decay, recursive=recursive)
        np.testing.assert_allclose(found.weights, expected, rtol=1e-11)


@pytest.mark.parametrize("trace_decay", [0.0, 0.7])
def test_it_approaches_the_fixed_point_of_td(trace_decay: float) -> None:
    geometry = linear_geometry(
        random_mdp(6, 2, 1, actions=2), np.tile([0.3, 0.7], (6, 1)), FEATURES, GAMMA, trace_decay=trace_decay
    )
    far, near = (
        np.abs(learned(count, trace_decay=trace_decay).weights - geometry.td_fixed_point).max() for count in (50, 8_000)
    )
    assert near < 0.1 < far


def test_an_episode_at_once_is_the_same_as_its_steps() -> None:
    env = gym.make("qtab/BoyanChain-v0").unwrapped
    whole, single = LSTD(4, trace_decay=0.5), LSTD(4, trace_decay=0.5)
    rng = np.random.default_rng(0)
    for _ in range(20):
        states = [12]
        while states[-1] > 0:
            states.append(states[-1] - 1 if states[-1] == 1 else states[-1] - int(rng.integers(1, 3)))
        rewards = [-3.0 if state > 1 else -2.0 for state in states[:-1]]
        features: Array = env.features[states]  # type: ignore[attr-defined]
        # The last state is not terminal: the episode goes on with a reward of zero.
        whole.learn_episode(features, rewards, terminated=False)
        single.start_episode()
        for x, reward, next_x in zip(features[:-1], rewards, features[1:], strict=True):
            single.update(x, reward, next_x)
        end = np.zeros((2, 4))
        end[0] = features[-1]
        whole.learn_episode(end, [0.0])
        single.start_episode()
        single.update(features[-1], 0.0, np.ones(4), terminated=True)
    assert whole.weights.tobytes() == single.weights.tobytes()


def test_the_exact_weights_of_boyans_chain_are_found() -> None:
    env: Any = gym.make("qtab/BoyanChain-v0").unwrapped
    geometry = linear_geometry(env, "random", env.features)
    np.testing.assert_allclose(geometry.values, -2.0 * np.arange(13), atol=1e-12)
    for weights in (geometry.td_fixed_point, geometry.minimizer("value_error"), geometry.minimizer("bellman_error")):
        np.testing.assert_allclose(weights, [-24.0, -16.0, -8.0, 0.0], atol=1e-10)
    assert qtab.train(env, seed=0, episodes=2).config.backend == "rust"


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: LSTD(0), ValueError, "n_features must be an integer of at least 1"),
        (
            lambda: LSTD(10**6),
            MemoryError,
            "matrices of 1,000,000 x 1,000,000 numbers for 1,000,000 features would take",
        ),
        (lambda: LSTD(3, epsilon=0.0), ValueError, "epsilon must be above 0, got 0"),
        (lambda: LSTD(3, epsilon=1e-309), ValueError, "epsilon must have a finite reciprocal if recursive, got 1e-309"),
        (lambda: LSTD(3, trace_decay=2), ValueError, r"trace_decay must lie in \[0, 1\]"),
        (
            lambda: LSTD(3).update([1, 2], 0.0, [1, 2, 3]),
            ValueError,
            r"features must have the shape \(3,\), got \(2,\)",
        ),
        (lambda: LSTD(3).update([1, 2, 3], 0.0, [1, 2, np.inf]), ValueError, "next_features must be finite"),
        (lambda: LSTD(3).learn_episode(np.ones((4, 3)), [0.0]), ValueError, r"got \(4, 3\) and \(1,\)"),
    ],
)
def test_bad_arguments_are_refused(call: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        call()


def test_a_singular_matrix_is_refused() -> None:
    found = LSTD(1, 1.0, epsilon=1.0, recursive=False)
    found.update([1.0], 0.0, [2.0])  # A = 1 + 1 (1 - 2)
    with pytest.raises(ValueError, match="A is singular"):
        _ = found.weights
    assert repr(found) == "<LSTD of 1 feature: discount 1, λ = 0, ε = 1>"


def test_a_singular_matrix_is_refused_by_the_recursion() -> None:
    found, other = LSTD(1, 1.0, epsilon=1.0, trace_decay=0.5), LSTD(1, 1.0, epsilon=1.0, trace_decay=0.5)
    with pytest.raises(ValueError, match="A is singular after these transitions"):
        found.update([1.0], 3.0, [2.0])
    for learner in (found, other):  # the refused transition has no effect
        learner.update([1.0], 1.0, [0.5])
    assert found.weights.tobytes() == other.weights.tobytes()
    assert found.b.tobytes() == other.b.tobytes()


@pytest.mark.parametrize("recursive", [True, False])
@pytest.mark.filterwarnings("ignore:overflow:RuntimeWarning", "ignore:invalid value:RuntimeWarning")
def test_weights_that_overflow_are_refused(recursive: bool) -> None:
    found = LSTD(1, 1.0, epsilon=1e-300, recursive=recursive)
    found.update([1e-10], 1e300, [1e-10])
    with pytest.raises(ValueError, match="the weights are not finite"):
        _ = found.weights
