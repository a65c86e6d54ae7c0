"""Tile coding: active rows equal the formula, and options that do not apply are refused."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab
from qtab.reference.parts.discretizers import TileCoding


class Shown(gym.Env[Any, Any]):
    """Always shows the same observation."""

    action_space = gym.spaces.Discrete(1)

    def __init__(self, space: gym.spaces.Box, observation: Any) -> None:
        self.observation_space = space
        self.observation = observation

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        return self.observation, {}

    def step(self, action: int) -> Any:
        return self.observation, 1.0, True, False, {}


def formula(
    observation: Any, low: Any, high: Any, tiles: Any, tilings: int, hashed_rows: int | None = None
) -> list[int]:
    """Each row is the tiling and the coordinates in C order, or their hash."""
    rows = []
    for t in range(tilings):
        row, numbers = t, [t]
        for i, x in enumerate(observation):
            x = min(max(float(x), low[i]), high[i])
            q = int(np.floor((x - low[i]) * (tiles[i] / (high[i] - low[i])) * tilings))
            numbers.append((q + (t * (2 * i + 1)) % tilings) // tilings)
            row = row * (tiles[i] + 1) + numbers[-1]
        rows.append(row if hashed_rows is None else splitmix(numbers, hashed_rows))
    return rows


def splitmix(numbers: list[int], rows: int) -> int:
    """The hash in NumPy's 64-bit integers, which wrap around."""
    word = np.zeros(1, np.uint64)
    for number in numbers:
        word = word + np.uint64(number) + np.uint64(0x9E3779B97F4A7C15)
        word = (word ^ word >> np.uint64(30)) * np.uint64(0xBF58476D1CE4E5B9)
        word = (word ^ word >> np.uint64(27)) * np.uint64(0x94D049BB133111EB)
        word = word ^ word >> np.uint64(31)
    return int(word[0] >> np.uint64(32)) * rows // 2**32


@st.composite
def observations(draw: st.DrawFn) -> tuple[Any, ...]:
    hashed = draw(st.sampled_from([None, 1, 3, 256, 100_000]))
    dimensions = draw(st.integers(1, 3 if hashed is None else 12))
    low = [draw(st.floats(-100, 100)) for _ in range(dimensions)]
    high = [edge + draw(st.floats(1e-3, 100)) for edge in low]
    tiles = tuple(draw(st.integers(1, 12)) for _ in range(dimensions))
    dtype = draw(st.sampled_from([np.float32, np.float64]))
    shown = [draw(st.one_of(st.floats(-300, 300), st.sampled_from([low[i], high[i]]))) for i in range(dimensions)]
    return np.array(shown, dtype=dtype), tuple(low), tuple(high), tiles, draw(st.integers(1, 32)), hashed


@given(observations())
def test_active_rows_equal_the_formula(case: tuple[Any, ...]) -> None:
    observation, low, high, tiles, tilings, hashed = case
    space = gym.spaces.Box(-np.inf, np.inf, observation.shape, observation.dtype.type)
    env = Shown(space, observation)
    options = {"low": low, "high": high, "tiles": tiles, "tilings": tilings, "hashed_rows": hashed}
    run = qtab.train(env, discretizer="tiles", **options, episodes=1, initial_q=0.0, seed=0)
    expected = formula(observation, low, high, tiles, tilings, hashed)
    assert np.flatnonzero(run.tables[0, :, 0]).tolist() == sorted(set(expected))
    assert run.discretizer.active_rows(observation).tolist() == expected
    assert TileCoding(space, run.config).rows(observation) == expected
    assert run.tables.shape == (1, hashed or tilings * np.prod(np.array(tiles) + 1), 1)
    assert qtab.verify(run, env=env).equal


def test_each_weight_is_updated_by_its_share() -> None:
    env = Shown(gym.spaces.Box(0.0, 1.0, (2,), np.float64), np.array([0.5, 0.5]))
    run = qtab.train(env, discretizer="tiles", tilings=4, learning_rate=0.5, episodes=1, initial_q=0.0, seed=0)
    assert run.tables[run.tables != 0.0].tolist() == [0.125] * 4
    assert run.q_values(np.array([0.5, 0.5])).tolist() == [0.5]


def test_a_row_that_is_active_twice_counts_twice() -> None:
    observation = np.array([0.5, 0.5])
    env = Shown(gym.spaces.Box(0.0, 1.0, (2,), np.float64), observation)
    run = qtab.train(
        env, discretizer="tiles", tilings=4, hashed_rows=1, learning_rate=0.5, episodes=1, initial_q=0.0, seed=0
    )
    assert run.discretizer.active_rows(observation).tolist() == [0, 0, 0, 0]
    assert run.tables.tolist() == [[[4 * 0.125]]]
    assert run.q_values(observation).tolist() == [4 * 0.5]


def test_a_table_too_large_for_its_tiles_is_hashed() -> None:
    env = Shown(gym.spaces.Box(0.0, 1.0, (40,), np.float32), np.full(40, 0.3, np.float32))
    with pytest.raises(
        ValueError, match=r"^tiles must give .* or hashed_rows= of your choice, got .* needs 1.18e\+39$"
    ):
        qtab.train(env, discretizer="tiles")
    run = qtab.train(env, discretizer="tiles", hashed_rows=5000, episodes=3, seed=0)
    assert run.tables.shape == (1, 5000, 1)
    assert qtab.verify(run, env=env).equal


COUNTED = r"^tiles times tilings must be less than 2\*\*32 - 1 along each component, got tiles"


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"low": (0.0,), "high": (5e-324,)}, "high must not be so close to low, got low="),
        ({"low": (-1e308,), "high": (1e308,)}, "high - low must be finite in float64, got low="),
        ({"tiles": 2**31, "tilings": 2}, f"{COUNTED}=\\(2147483648,\\) and tilings=2$"),
        ({"tiles": 2**32 - 1, "tilings": 1}, f"{COUNTED}=\\(4294967295,\\) and tilings=1$"),
        ({"tiles": 2**70}, "tiles must be an integer from 1 to 4294967295, got 1180591620717411303424"),
    ],
)
def test_tiles_that_cannot_be_told_apart_or_counted_are_refused(options: Any, match: str) -> None:
    env = Shown(gym.spaces.Box(-np.inf, np.inf, (1,), np.float64), np.zeros(1))
    with pytest.raises(ValueError, match=match):
        qtab.train(env, discretizer="tiles", **{"low": (0.0,), "high": (1.0,), **options}, hashed_rows=100, episodes=1)


def test_as_many_tiles_as_can_be_counted_are_told_apart() -> None:
    env = Shown(gym.spaces.Box(0.0, 1.0, (1,), np.float64), np.array([1.0]))
    options: dict[str, Any] = {"discretizer": "tiles", "tiles": 2**30 - 1, "tilings": 4, "hashed_rows": 1000}
    run = qtab.train(env, **options, episodes=2, seed=0)
    assert qtab.verify(run, env=env).equal


def test_one_number_of_tiles_is_for_every_component() -> None:
    run = qtab.train("MountainCar-v0", episodes=1, discretizer="tiles", tiles=5)
    assert run.config.tiles == (5, 5)


def test_the_limits_must_be_given_where_the_space_has_none() -> None:
    env = Shown(gym.spaces.Box(-np.inf, np.inf, (1,), np.float32), np.zeros(1, dtype=np.float32))
    with pytest.raises(
        ValueError,
        match=r"^low must be given, a number for each component, as the observation space has no finite bounds: ",
    ):
        qtab.train(env, discretizer="tiles")


def test_nan_in_an_observation_is_refused() -> None:
    env = Shown(gym.spaces.Box(0.0, 1.0, (2,), np.float64), np.array([0.5, np.nan]))
    with pytest.raises(ValueError, match=r"observation\[1\] is NaN"):
        qtab.train(env, discretizer="tiles")


@pytest.fixture(scope="module")
def run() -> qtab.Run:
    return qtab.train(
        "MountainCar-v0",
        seed=0,
        episodes=300,
        algorithm="sarsa_lambda",
        discretizer="tiles",
        learning_rate=0.3,
        discount=1.0,
        epsilon=0.0,
        initial_q=0.0,
    )


def test_tile_coding_has_no_cells_and_suggests_alternatives(run: qtab.Run) -> None:
    for name, method in (("q_table", "q_values"), ("policy", "predict")):
        with pytest.raises(ValueError, match=rf"^{name} needs cells, .*; run\.{method}\(observation\) works$"):
            getattr(run, name)


def test_a_run_with_tile_coding_predicts(run: qtab.Run) -> None:
    observation = np.array([-0.5, 0.0], dtype=np.float32)
    values = run.q_values(observation)
    assert values.shape == (3,)
    assert run.predict(observation) == (int(np.argmax(values)), None)
    with pytest.raises(ValueError, match=r"observation must have shape \(2,\)"):
        run.q_values([0.0])
    with pytest.raises(ValueError, match=r"observation\[0\] is NaN"):
        run.q_values([float("nan"), 0.0])


def test_a_run_with_tile_coding_is_saved_and_loaded(run: qtab.Run, tmp_path: Any) -> None:
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.tables.tobytes() == run.tables.tobytes()
    observation = np.array([-0.5, 0.01], dtype=np.float32)
    assert loaded.q_values(observation).tobytes() == run.q_values(observation).tobytes()
    assert vars(loaded.config) == vars(run.config)
    assert qtab.verify(loaded, episodes=2).equal


def test_a_hashed_run_is_saved_loaded_and_evaluated(tmp_path: Any) -> None:
    run = qtab.train("MountainCar-v0", preset="solved", hashed_rows=1500, episodes=300, seed=0)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.tables.tobytes() == run.tables.tobytes()
    assert loaded.config.hashed_rows == 1500
    assert qtab.verify(loaded, episodes=2).equal
    observation = np.array([-0.5, 0.01], dtype=np.float32)
    assert loaded.q_values(observation).tobytes() == run.q_values(observation).tobytes()
    assert qtab.evaluate(loaded, episodes=20, seed=1).mean_return > -150


def test_a_run_with_tile_coding_is_evaluated(run: qtab.Run) -> None:
    assert qtab.evaluate(run, episodes=20, seed=1).mean_return > -150


def test_tile_coding_solves_mountain_car(run: qtab.Run) -> None:
    assert run.episode_returns[-100:].mean() > -125
