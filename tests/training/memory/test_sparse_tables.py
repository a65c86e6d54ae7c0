"""Tables whose rows are assigned as observations are seen: `max_rows`."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.spaces import Box, Dict, Discrete, MultiDiscrete, Tuple

import qtab
from support.environments import Sampled
from support.environments.gridworld import Tutorial
from support.parity import assert_same_run

SETTINGS: dict[str, Any] = {"episodes": 30, "seed": 5, "max_episode_steps": 40, "initial_q": 0.0}


def test_a_sparse_table_learns_what_a_full_one_does() -> None:
    full = qtab.train(Tutorial(3), **SETTINGS)
    sparse = qtab.train(Tutorial(3), max_rows=81, **SETTINGS)
    assert sparse.tables.shape == (1, 82, 4)
    assert full.episode_returns.tobytes() == sparse.episode_returns.tobytes()
    seen = sparse.discretizer.n_seen  # type: ignore[attr-defined]
    assert seen == np.unique(full.tables[0].nonzero()[0]).size + np.count_nonzero(~sparse.tables[0][:seen].any(axis=1))
    for agent in np.ndindex(3, 3):
        observation = {"agent": np.array(agent), "target": np.array([2, 1])}
        assert np.array_equal(sparse.q_values(observation), full.q_values(observation))
    assert qtab.verify(sparse, env=Tutorial(3)).equal
    assert [axis.name for axis in sparse.axes] == ["row"]


def test_what_was_not_met_has_the_initial_values_of_the_last_row() -> None:
    env = Sampled(Box(0, 10**9, (3,), np.int64))
    run = qtab.train(env, max_rows=100, **{**SETTINGS, "initial_q": (-1.0, 1.0), "episodes": 2})
    observation = np.array([1, 2, 3])
    assert run.discretizer.row(observation) == 100
    assert np.array_equal(run.q_values(observation), run.tables[0][100])
    assert run.predict(np.stack([observation] * 3))[0].tolist() == [run.predict(observation)[0]] * 3
    assert qtab.evaluate(run, episodes=20, seed=9, env=env).lengths.sum() > 100  # most of which was not seen


def test_a_full_table_is_refused_with_what_was_learned() -> None:
    with pytest.raises(
        ValueError, match=r"^max_rows must be more than 7: all rows are assigned, and training saw another"
    ) as caught:
        qtab.train(Sampled(Box(0, 255, (5,), np.uint8)), max_rows=7, **SETTINGS)
    run = caught.value.run  # type: ignore[attr-defined]
    assert run.discretizer.n_seen == 7
    assert run.predict(np.zeros(5, np.uint8))


def test_a_saved_run_keeps_its_rows_and_is_resumed_with_them(tmp_path: Path) -> None:
    def make() -> Tutorial:
        return Tutorial(5)

    settings: dict[str, Any] = {**SETTINGS, "max_rows": 500, "initial_q": (-1.0, 1.0)}
    whole = qtab.train(make(), **settings)

    def stop(progress: Any) -> bool:
        return bool(progress.episode < 12)

    part = qtab.train(make(), callback=stop, callback_every=4, **settings)
    assert 0 < len(part.episode_returns) < 30
    assert part.discretizer.n_seen < whole.discretizer.n_seen  # type: ignore[attr-defined]
    part.save(tmp_path / "part.npz")
    loaded = qtab.load(tmp_path / "part.npz")
    space = make().observation_space
    for _ in range(10):
        observation = space.sample()
        assert loaded.predict(observation) == part.predict(observation)
    resumed = qtab.resume(loaded, env=make())
    assert_same_run(resumed, whole)
    assert resumed.discretizer.arrays()["met"].tolist() == whole.discretizer.arrays()["met"].tolist()
    assert part.discretizer.n_seen < whole.discretizer.n_seen  # type: ignore[attr-defined]


def test_a_function_without_a_shape_names_cells_by_any_integers() -> None:
    def place(observation: Any) -> tuple[int, ...]:
        return (*observation["agent"].tolist(), -(10**12))

    run = qtab.train(Tutorial(3), discretizer=place, max_rows=9, **SETTINGS)
    assert run.discretizer.n_seen == 9  # type: ignore[attr-defined]
    assert qtab.verify(run, env=Tutorial(3)).equal
    with pytest.raises(ValueError, match="discretizer must return the same number of integers each time, got"):
        qtab.train(Tutorial(3), discretizer=lambda o: [0] * (1 + o["agent"][0]), max_rows=9, **SETTINGS)


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"discretizer": "tiles"}, "max_rows applies to discretizer 'round', .* not to 'tiles'"),
        ({"initial_q": np.zeros((10, 4))}, "initial_q must be a number or a range with max_rows"),
        ({"max_rows": 2**31}, r"max_rows must give a table of fewer than 2\*\*32 values"),
    ],
    ids=str,
)
def test_what_does_not_go_with_max_rows(settings: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        qtab.train(Tutorial(3), **{"max_rows": 9, **SETTINGS, **settings})


def test_tiles_by_key_do_not_go_with_max_rows() -> None:
    env = Sampled(Dict(room=Discrete(5), speed=Box(-1.0, 1.0, (2,))))
    with pytest.raises(ValueError, match="max_rows does not apply to discretizer 'tiles'"):
        qtab.train(env, discretizer={"speed": "tiles"}, max_rows=9, **SETTINGS)


@pytest.mark.slow
def test_the_tables_of_many_runs_have_different_rows_and_are_not_kept() -> None:
    def make() -> gym.Env:
        return Tutorial(3)

    settings = {name: value for name, value in SETTINGS.items() if name != "seed"} | {"episodes": 3}
    with pytest.raises(ValueError, match=r"^tables must be left out with max_rows"):
        qtab.train_many(make, seeds=2, tables=True, max_rows=81, **settings)
    runs = qtab.train_many(make, seeds=2, threads=1, max_rows=81, **settings)
    single = qtab.train(make(), seed=1, max_rows=81, **settings)
    assert runs.episode_returns[1].tobytes() == single.episode_returns.tobytes()
    assert runs.episode_lengths[1].tolist() == single.episode_lengths.tolist()


def test_a_verified_run_leaves_its_rows_as_they_are() -> None:
    run = qtab.train(Tutorial(3), max_rows=81, **SETTINGS)
    seen = run.discretizer.n_seen  # type: ignore[attr-defined]
    assert qtab.verify(run, 3, env=Tutorial(3)).equal
    assert run.discretizer.n_seen == seen  # type: ignore[attr-defined]
    assert_same_run(run, qtab.train(Tutorial(3), config=run.config))


class Counted(gym.Env[Any, Any]):
    """Shows one of two numbers that floats do not tell apart, beside a float."""

    def __init__(self, numbers: tuple[int, int], dtype: Any = np.int64) -> None:
        self.numbers, self.dtype = numbers, dtype
        self.observation_space = Dict(
            count=Box(np.iinfo(dtype).min, np.iinfo(dtype).max, (), dtype), x=Box(0.0, 1.0, ())
        )
        self.action_space = Discrete(2)

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.last = int(self.np_random.integers(2))
        return self.seen(self.last), {}

    def step(self, action: Any) -> Any:
        return self.seen(self.last), float(self.last), True, False, {}

    def seen(self, which: int) -> dict[str, Any]:
        return {"count": np.array(self.numbers[which], self.dtype), "x": np.array(0.5, np.float32)}


@pytest.mark.parametrize(
    ("numbers", "dtype"),
    [((2**53, 2**53 + 1), np.int64), ((-(2**63), 1 - 2**63), np.int64), ((2**64 - 2, 2**64 - 1), np.uint64)],
    ids=str,
)
def test_large_integers_beside_floats_have_rows_of_their_own(
    numbers: tuple[int, int], dtype: Any, tmp_path: Path
) -> None:
    env = Counted(numbers, dtype)
    run = qtab.train(env, discretizer="bins", max_rows=9, **{**SETTINGS, "learning_rate": 1.0})
    assert run.discretizer.n_seen == 2  # type: ignore[attr-defined]
    assert qtab.verify(run, env=env).equal
    run.save(tmp_path / "run.npz")
    both = {"count": np.array(numbers, dtype), "x": np.full(2, 0.5, np.float32)}
    for one in (run, qtab.load(tmp_path / "run.npz")):
        assert [one.values(env.seen(which)) for which in range(2)] == [0.0, 1.0]
        assert one.values(both).tolist() == [0.0, 1.0]


def test_a_float_that_is_no_64_bit_integer_is_refused() -> None:
    run = qtab.train(Counted((0, 1)), discretizer="bins", max_rows=9, **SETTINGS)
    with pytest.raises(
        TypeError, match=r"^observation\['count'\] must hold integers, as the space does, got \[1e\+30\]"
    ):
        run.values({"count": np.array(1e30), "x": np.array(0.5, np.float32)})


def test_a_list_of_observations_of_a_tuple_space_is_no_batch() -> None:
    env = Sampled(Tuple((MultiDiscrete([2, 2]), MultiDiscrete([2, 3]))))
    run = qtab.train(env, **SETTINGS)
    observations = [(np.array([0, 1]), np.array([1, 1])), (np.array([1, 0]), np.array([0, 2]))]
    columns = tuple(np.stack(parts) for parts in zip(*observations, strict=True))
    expected = [run.q_values(observation).tolist() for observation in observations]
    assert run.q_values(columns).tolist() == expected
    assert run.q_values(list(observations[0])).tolist() == expected[0]
    with pytest.raises(
        ValueError, match=r"^observations of a Tuple space must be batched as a tuple with an array for"
    ):
        run.q_values(observations)


def test_plain_data_does_not_leave_out_how_observations_are_read(tmp_path: Path) -> None:
    for max_rows in (81, None):
        run = qtab.train(Tutorial(3), max_rows=max_rows, **SETTINGS)
        with pytest.raises(ValueError, match=r"^this run cannot be written: plain data describes"):
            run.to_json(tmp_path / "policy.json")
        assert not (tmp_path / "policy.json").exists()
