"""The equations of least-squares policy iteration: near singularity, for one step, with masks and features of runs."""

from typing import Any

import numpy as np
import pytest

import qtab
from qtab.planning import Transitions, lspi, lstdq
from qtab.planning.least_squares.equations import MATRICES


def test_weights_near_singularity_are_refused_or_right() -> None:
    features: Any = [[1, 1], [1, 1.00000038], [-1.05368555e-08, -1.01717793e-07], [-1.45813391e-07, 1.83721677e-07]]
    rewards = [0.22633684505562177, -1.3860827748063256, 0.09096013170226845, 0.39870471333605895]
    batch = Transitions([0, 1, 2, 3], [0, 0, 1, 1], rewards, [2, 3, 2, 3], [False] * 4)
    with pytest.raises(ValueError, match="A is singular"):
        lstdq(batch, features, 0, 0.9)


def test_features_that_differ_little_determine_their_weights() -> None:
    x = np.array([[1, 1], [1, 1 + 1e-7], [1, 3], [1, -5]])
    batch = Transitions([0, 1, 2, 3], [0, 0, 1, 1], [1.0, 2.0, 3.0, 4.0], [2, 3, 3, 2], [False] * 4)
    weights = lstdq(batch, x, 0, 0.9)
    errors = [
        reward + 0.9 * (x[following] @ weights[:, 0]) - x[state] @ weights[:, action]
        for state, action, reward, following in zip(
            batch.observations, batch.actions, batch.rewards, batch.next_observations, strict=True
        )
    ]
    assert np.abs(errors).max() < 1e-6 * np.abs(x @ weights).max()


def test_tasks_of_one_step_are_solved() -> None:
    batch = Transitions([0, 1, 0, 1], [0, 0, 1, 1], [1.0, 2.0, 3.0, 4.0], [0, 1, 0, 1], [True] * 4)
    assert lstdq(batch, np.eye(2), 0, 0.9).tolist() == [[1.0, 3.0], [2.0, 4.0]]


def test_the_initial_policy_is_masked() -> None:
    rng = np.random.default_rng(3)
    batch = Transitions(
        rng.integers(0, 3, 60), rng.integers(0, 2, 60), rng.normal(size=60), rng.integers(0, 3, 60), [False] * 60
    )
    x = np.eye(3)
    found = lspi(batch, x, 0.9, policy=0, action_mask=lambda state: [state != 1, True], max_iterations=1)
    assert np.array_equal(found.weights, lstdq(batch, x, np.array([0, 1, 0]), 0.9))
    assert not np.array_equal(found.weights, lstdq(batch, x, 0, 0.9))
    assert found.q_values([0, 1])[1, 0] == -np.inf
    assert np.isfinite(found.q_values([0])).all()


@pytest.mark.parametrize("epsilon", [0.0, 0.1])
def test_matrices_that_do_not_fit_into_memory_are_refused(epsilon: float, monkeypatch: pytest.MonkeyPatch) -> None:
    batch = Transitions([0, 1], [0, 1], [1.0, 2.0], [1, 0], [False, False])
    with pytest.raises(
        MemoryError, match=r"^matrices of 1,000,000 x 1,000,000 numbers for 1,000,000 features of 2 act"
    ):
        lspi(batch, np.ones((2, 10**6)), 0.9, epsilon=epsilon)
    monkeypatch.setattr("qtab._utils.memory.memory_limit", lambda _: 8 * MATRICES * 2 * 10**2)
    with pytest.raises(
        MemoryError, match=r"^matrices of 20 x 20 numbers for 10 features of 2 actions would take 25 KiB"
    ):
        lstdq(batch, np.ones((2, 10)), [0, 1], 0.9, epsilon=epsilon)  # the blocks of the actions fit, all of A does not


def test_a_discretizer_and_its_rows_are_not_feature_vectors() -> None:
    batch = Transitions.sample("MountainCar-v0", 200, seed=0)
    settings: dict[str, Any] = {"algorithm": "sarsa", "preset": None, "learning_rate": 0.001, "episodes": 1, "seed": 0}
    basis: Any = qtab.train("MountainCar-v0", discretizer="fourier", order=3, **settings).discretizer
    tiles: Any = qtab.train("MountainCar-v0", discretizer="tiles", **settings).discretizer
    as_vector = "return a vector that is 1 at its active_rows and 0 elsewhere"
    for given, hint in ((basis, "pass its method feature_values"), (tiles, as_vector), (tiles.active_rows, as_vector)):
        expected = f"^features must be an array or a function that returns vectors, got <.*>; {hint}$"
        with pytest.raises(TypeError, match=expected):
            lspi(batch, given)
    assert lspi(batch, basis.feature_values, epsilon=0.01).weights.shape == (16, 3)
    vector = lambda seen: np.isin(np.arange(tiles.n_rows), tiles.active_rows(seen))  # noqa: E731
    assert lspi(batch, vector, epsilon=0.01).weights.shape == (648, 3)
