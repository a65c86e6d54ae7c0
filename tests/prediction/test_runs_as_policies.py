"""Runs as policies of a prediction: with weighted features, with action masks, and with values that are not numbers."""

import dataclasses
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numpy.typing import NDArray

import qtab

CAR = "MountainCar-v0"
LSTD: dict[str, Any] = {"method": "lstd", "episodes": 4, "max_episode_steps": 30}
STATES: list[dict[str, Any]] = [
    {"discretizer": "fourier", "order": 2},
    {"discretizer": "coarse", "centers": 3},
    {"discretizer": "tiles", "tilings": 2, "tiles": 3},
    {"discretizer": "bins", "bins": 3},
]


def mask(at: Any) -> list[int]:
    return [1, 1, 0] if at[0] > 0 else [1, 1, 1]


class Field(gym.Env[Any, Any]):
    """Random places in a square; on its right half, there is no action 2, the best one elsewhere."""

    observation_space = gym.spaces.Box(-1.0, 1.0, (2,), np.float32)
    action_space = gym.spaces.Discrete(3)
    at: NDArray[np.float32]

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        super().reset(seed=seed)
        return self._moved()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        assert mask(self.at)[action], f"there is no action {action} at {self.at}"
        reward = float(action) + float(self.at[1])
        return self._moved()[0], reward, bool(self.np_random.random() < 0.1), False, self._info()

    def _moved(self) -> tuple[Any, dict[str, Any]]:
        self.at = self.np_random.uniform(-1, 1, 2).astype(np.float32)
        return self.at, self._info()

    def _info(self) -> dict[str, Any]:
        return {"action_mask": np.array(mask(self.at), np.int8)}


def choices(run: qtab.Run) -> Callable[[Any], int]:
    """The greedy policy of a run as a function."""
    return lambda observation: int(run.predict(observation)[0])


@pytest.mark.parametrize("states", STATES, ids=str)
@pytest.mark.parametrize("cells", [{"discretizer": "bins", "bins": 1}, {"discretizer": "tiles", "tiles": 2}], ids=str)
def test_a_run_with_a_function_of_masks_never_takes_an_excluded_action(
    cells: dict[str, Any], states: dict[str, Any]
) -> None:
    run = qtab.train(Field(), action_mask=mask, episodes=20, seed=0, progress=False, **cells)
    by_run = qtab.estimate_values(Field(), run, seeds=[1], **LSTD, **states)
    by_function = qtab.estimate_values(Field(), choices(run), seeds=[1], **LSTD, **states)
    assert by_run.weights.tobytes() == by_function.weights.tobytes()
    assert by_run.verify(env=Field()).equal


def test_a_run_with_the_masks_of_its_environment_is_a_policy_if_its_cells_keep_them() -> None:
    settings: dict[str, Any] = {"action_mask": True, "episodes": 20, "seed": 0, "progress": False}
    run = qtab.train(Field(), discretizer="bins", bins=2, **settings)
    values = qtab.estimate_values(Field(), run, discretizer="radial", **LSTD)
    assert values.verify(env=Field()).equal
    run = qtab.train(Field(), discretizer="tiles", **settings)
    with pytest.raises(
        ValueError, match=r"^policy must be a run that knows its action masks, got action_mask=True with"
    ):
        qtab.estimate_values(Field(), run, discretizer="radial", **LSTD)


def test_weighted_features_choose_among_the_actions_of_given_masks() -> None:
    run = qtab.train(CAR, discretizer="fourier", episodes=3, seed=0, max_episode_steps=50, progress=False)
    at = np.random.default_rng(0).uniform((-1.2, -0.07), (0.6, 0.07), (20, 2)).astype(np.float32)
    masks = np.random.default_rng(1).integers(2, size=(20, 3))
    masks[:, 1] = 1
    expected = np.where(masks, run.q_values(at), -np.inf).argmax(axis=1)
    assert np.array_equal(run.predict(at, action_masks=masks)[0], expected)
    assert not np.array_equal(run.predict(at)[0], expected)


@pytest.mark.parametrize("kind", ["fourier", "radial", "coarse"])
def test_a_value_that_is_not_a_number_is_the_largest_as_for_argmax(kind: Any) -> None:
    run = qtab.train(CAR, discretizer=kind, episodes=1, seed=0, max_episode_steps=5, progress=False)
    tables = np.random.default_rng(0).choice([-1.7e308, 0.0, 1.7e308], run.tables.shape)
    run = dataclasses.replace(run, tables=tables)
    at = np.random.default_rng(2).uniform((-1.2, -0.07), (0.6, 0.07), (100, 2)).astype(np.float32)
    with np.errstate(over="ignore", invalid="ignore"):
        values = run.q_values(at)
        assert np.isnan(values).any()
        assert np.array_equal(run.predict(at)[0], np.argmax(values, axis=1))
        by_run, by_function = (qtab.estimate_values(CAR, policy, **LSTD, **STATES[2]) for policy in (run, choices(run)))
        assert by_run.weights.tobytes() == by_function.weights.tobytes()
        assert by_run.verify().equal


def test_a_run_without_cells_has_no_policy_for_numbered_states() -> None:
    run = qtab.train(CAR, discretizer="fourier", episodes=1, max_episode_steps=5, progress=False)
    with pytest.raises(
        ValueError,
        match=r"^policy must be a run with a table of shape \(16, 4\), got one without: <FourierBasis: 16 feat",
    ):
        qtab.policy_values("FrozenLake-v1", run)


@pytest.mark.parametrize("kind", ["fourier", "tiles"])
def test_a_function_of_features_beside_a_discretizer_is_told_what_to_use(kind: Any) -> None:
    with pytest.raises(
        ValueError, match=r"^features must be None for discretizer .*; to learn with features of your own"
    ):
        qtab.estimate_values(CAR, "random", learning_rate=0.1, features=lambda at: at, discretizer=kind)
