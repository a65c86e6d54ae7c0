"""A function of the observation that returns features: by a wrapper, and refused as a discretizer."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numpy.typing import NDArray

import qtab

CAR = "MountainCar-v0"
OWN: dict[str, Any] = {"discretizer": "polynomial", "order": 1, "coupled": False}


def features(observation: Any) -> NDArray[np.float64]:
    position, velocity = (float(observation[0]) + 1.2) / 1.8, (float(observation[1]) + 0.07) / 0.14
    return np.array([position, velocity, np.exp(-20 * (position - 0.4) ** 2)])


def wrapped() -> gym.Env[Any, Any]:
    space = gym.spaces.Box(0.0, 1.0, (3,), np.float64)
    return gym.wrappers.TransformObservation(gym.make(CAR), features, space)


def test_the_numbers_of_a_wrapper_are_the_features() -> None:
    run = qtab.train(wrapped(), algorithm="sarsa_lambda", learning_rate=0.001, episodes=3, seed=0, **OWN)
    assert run.tables.shape == (1, 4, 3)
    assert qtab.verify(run, env=wrapped()).equal
    seen, _ = gym.make(CAR).reset(seed=1)
    x = features(seen)
    assert run.discretizer.active_features(x).tolist() == [1.0, *x.tolist()]
    np.testing.assert_allclose(run.q_values(x), run.tables[0, 0] + x @ run.tables[0, 1:], rtol=1e-12)


@pytest.mark.parametrize("rows", [{"shape": (3,)}, {"max_rows": 10}], ids=["shape", "max_rows"])
def test_a_function_that_returns_floats_is_told_what_to_use(rows: dict[str, Any]) -> None:
    with pytest.raises(TypeError, match=r"^discretizer must return .* got array.*; to learn with features of your own"):
        qtab.train(CAR, episodes=1, discretizer=features, **rows)
    with pytest.raises(TypeError, match=r"^discretizer must return .*, got 'left'$"):
        qtab.train(CAR, episodes=1, discretizer=lambda observation: "left", **rows)
