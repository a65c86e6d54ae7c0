"""A function as the discretizer: what it returns is checked, and a saved run asks for it."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.spaces import Box, Dict, Discrete, Text, Tuple
from gymnasium.vector.utils import concatenate, create_empty_array

import qtab
from support.environments import Sampled
from support.environments.gridworld import Tutorial
from support.parity import assert_same_run

SETTINGS: dict[str, Any] = {"episodes": 3, "seed": 5, "max_episode_steps": 40}


def cells(observation: Any) -> tuple[int, int]:
    """The article's grid."""
    position, velocity = observation
    return int(np.rint((position + 1.2) * 10)), int(np.rint((velocity + 0.07) * 100))


def test_the_articles_grid_as_a_function_learns_what_the_article_does() -> None:
    settings: dict[str, Any] = {"episodes": 8, "seed": 0}
    ours = qtab.train("MountainCar-v0", discretizer=cells, shape=(19, 15), **settings)
    theirs = qtab.train("MountainCar-v0", **settings)
    assert ours.config.backend == "gymnasium"
    assert ours.q_table.tobytes() == theirs.q_table.tobytes()
    assert qtab.verify(ours).equal
    observations = np.array([[-0.5, 0.01], [0.3, -0.02], [-1.2, 0.0]], np.float32)
    assert ours.predict(observations)[0].tolist() == theirs.predict(observations)[0].tolist()
    assert ours.predict(observations[0])[0] == theirs.predict(observations[0])[0]
    assert [axis.name for axis in ours.axes] == ["cells[0]", "cells[1]"]
    played = qtab.evaluate(ours, episodes=3, seed=1)
    assert played.lengths.tolist() == qtab.evaluate(theirs, episodes=3, seed=1).lengths.tolist()


def test_one_integer_is_the_number_of_a_row() -> None:
    def row(observation: Any) -> int:
        first, second = cells(observation)
        return first * 15 + second

    ours, flat = (qtab.train("MountainCar-v0", discretizer=row, shape=shape, **SETTINGS) for shape in ((19, 15), 285))
    assert flat.config.shape == (285,)
    assert flat.tables.tobytes() == ours.tables.tobytes()
    expected = qtab.train("MountainCar-v0", discretizer=cells, shape=(19, 15), **SETTINGS)
    assert_same_run(ours, expected)
    assert qtab.verify(ours).equal
    assert qtab.verify(flat).equal


@pytest.mark.parametrize(
    ("returned", "error", "text"),
    [
        ((19, 0), ValueError, r"discretizer must return 2 indices within the shape \(19, 15\), .*, got \(19, 0\)$"),
        ((0, -1), ValueError, r"got \(0, -1\)$"),
        ((1,), ValueError, r"got \(1,\)$"),
        (285, ValueError, "or the number of a row, got 285"),
        (1.0, TypeError, r"discretizer must return integers, 2 indices .*, got 1.0$"),
        ("left", TypeError, "got 'left'$"),
        (None, TypeError, "got None$"),
        ([1, [2]], TypeError, r"discretizer must return integers, 2 indices .*, got \[1, \[2\]\]$"),
        ([[0, 0]], TypeError, r"got \[\[0, 0\]\]$"),
        (2**70, ValueError, "or the number of a row, got 1180591620717411303424$"),
    ],
    ids=str,
)
def test_what_the_function_returns_is_checked_at_each_call(returned: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        qtab.train("MountainCar-v0", discretizer=lambda _: returned, shape=(19, 15), **SETTINGS)


@pytest.mark.parametrize(("returned", "error"), [(7, ValueError), (-1, ValueError), (1.0, TypeError)])
def test_one_index_is_asked_for_where_the_shape_has_one_axis(returned: Any, error: type[Exception]) -> None:
    with pytest.raises(error, match=f"discretizer must return an integer from 0 to 4, got {returned}$"):
        qtab.train("MountainCar-v0", discretizer=lambda _: returned, shape=5, **SETTINGS)


def test_an_error_of_the_function_reaches_the_user_with_the_run() -> None:
    def fail(observation: Any) -> int:
        raise KeyError(str(observation))

    with pytest.raises(KeyError, match=r"\[-0\.") as caught:
        qtab.train("MountainCar-v0", discretizer=fail, shape=3, **SETTINGS)
    assert len(caught.value.run.episode_returns) == 0  # type: ignore[attr-defined]


def test_a_saved_run_asks_for_its_function(tmp_path: Path) -> None:
    run = qtab.train("MountainCar-v0", discretizer=cells, shape=(19, 15), **SETTINGS)
    run.save(tmp_path / "run.npz")
    without = qtab.load(tmp_path / "run.npz")
    observation = np.array([-0.5, 0.0], np.float32)
    for use in (lambda: without.predict(observation), lambda: qtab.verify(without), lambda: qtab.evaluate(without)):
        with pytest.raises(
            ValueError, match=r"is the function 'cells', .*: qtab.load\(path, discretizer=...\) restores it"
        ):
            use()
    assert without.q_table.tobytes() == run.q_table.tobytes()
    without.save(tmp_path / "again.npz")
    assert (tmp_path / "again.npz").stat().st_size == (tmp_path / "run.npz").stat().st_size
    loaded = qtab.load(tmp_path / "again.npz", discretizer=cells)
    assert loaded.config == run.config
    assert loaded.predict(observation) == run.predict(observation)
    assert qtab.verify(loaded).equal
    assert len(qtab.resume(loaded, 6).episode_returns) == 6
    assert_same_run(qtab.train(resume=tmp_path / "run.npz", discretizer=cells, episodes=6), qtab.resume(loaded, 6))
    with pytest.raises(ValueError, match=r"^discretizer must be that of the run to resume"):
        qtab.train(resume=loaded, discretizer=len)
    qtab.train("MountainCar-v0", **SETTINGS).save(tmp_path / "plain.npz")
    with pytest.raises(
        TypeError, match="discretizer must be that of the file, which is 'round', not a function, got <function cells"
    ):
        qtab.load(tmp_path / "plain.npz", discretizer=cells)
    with pytest.raises(TypeError, match="discretizer must be that of the file, which is a function, got 3"):
        qtab.load(tmp_path / "run.npz", discretizer=3)  # type: ignore[arg-type]


def test_a_function_serves_spaces_that_hold_no_numbers() -> None:
    env = Sampled(Dict(note=Text(5), image=Box(0, 255, (8, 8, 3), np.uint8)))
    run = qtab.train(
        env, discretizer=lambda o: (len(o["note"]), int(o["image"].mean()) // 64), shape=(6, 4), **SETTINGS
    )
    assert run.q_table.shape == (6, 4, 3)
    assert qtab.verify(run, env=env).equal


@pytest.mark.parametrize("max_rows", [None, 50])
@pytest.mark.parametrize(
    "space", [Dict(a=Discrete(3), b=Box(0, 2, (2,), np.int64)), Tuple((Discrete(3), Discrete(2)))], ids=str
)
def test_a_function_gets_the_observations_of_a_batch_one_by_one(
    space: Any, max_rows: int | None, tmp_path: Path
) -> None:
    def place(observation: Any) -> Any:
        first, second = observation.values() if isinstance(observation, dict) else observation
        return int(first), int(np.sum(second))

    table: dict[str, Any] = {"shape": (3, 5)} if max_rows is None else {"max_rows": max_rows}
    run = qtab.train(Sampled(space), discretizer=place, **table, **SETTINGS)
    run.save(tmp_path / "run.npz")
    space.seed(1)
    for count in (1, 2, 3):
        observations = [space.sample() for _ in range(count)]
        empty: Any = create_empty_array(space, count)
        batch = concatenate(space, observations, empty)
        for one in (run, qtab.load(tmp_path / "run.npz", discretizer=place)):
            values = np.array([one.q_values(observation) for observation in observations])
            assert one.q_values(batch).tobytes() == values.tobytes()
            assert one.q_values(batch).shape == (count, 3)


def test_what_a_function_needs_and_what_needs_a_function() -> None:
    with pytest.raises(ValueError, match=r"^shape must be given for a function as the discretizer, .* or max_rows=$"):
        qtab.train("MountainCar-v0", discretizer=cells, **SETTINGS)
    with pytest.raises(ValueError, match="shape applies to discretizer 'function', not to 'round', got"):
        qtab.train("MountainCar-v0", shape=(19, 15), **SETTINGS)
    with pytest.raises(ValueError, match="scale applies to discretizer 'round', not to 'function', got"):
        qtab.train("MountainCar-v0", discretizer=cells, shape=(19, 15), scale=(10, 100), **SETTINGS)
    with pytest.raises(ValueError, match=r"shape must give a table of fewer than 2\*\*32 values"):
        qtab.train("MountainCar-v0", discretizer=cells, shape=(10**6, 10**6), **SETTINGS)


@pytest.mark.parametrize("returned", [2**63, -(2**63) - 1, 10**30, (0, 2**64), np.uint64(2**63), [2**63, -1]], ids=str)
def test_an_integer_beyond_64_bits_is_refused_by_name(returned: Any) -> None:
    with pytest.raises(ValueError, match=r"^discretizer must return integers from -2\*\*63 to 2\*\*63 - 1, got "):
        qtab.train("MountainCar-v0", discretizer=lambda _: returned, max_rows=9, **SETTINGS)
    with pytest.raises(
        ValueError, match=r"^discretizer must return 2 indices within the shape \(19, 15\), or the number"
    ):
        qtab.train("MountainCar-v0", discretizer=lambda _: returned, shape=(19, 15), **SETTINGS)


def test_the_largest_integers_of_64_bits_are_cells() -> None:
    ends = (-(2**63), 2**63 - 1)
    run = qtab.train("MountainCar-v0", discretizer=lambda seen: ends[int(seen[1] > 0)], max_rows=2, **SETTINGS)
    assert run.discretizer.n_seen == 2  # type: ignore[attr-defined]


@pytest.mark.slow
def test_many_runs_share_a_function(tmp_path: Path) -> None:
    def make() -> gym.Env:
        return gym.make("MountainCar-v0")

    settings: dict[str, Any] = {"discretizer": cells, "shape": (19, 15), "episodes": 2, "max_episode_steps": 30}
    runs = qtab.train_many(make, seeds=2, threads=1, tables=True, **settings)
    assert_same_run(runs[1], qtab.train(make(), seed=1, **settings))
    runs.save(tmp_path / "runs.npz")
    observation = np.array([-0.5, 0.0], np.float32)
    loaded = qtab.load_runs(tmp_path / "runs.npz", discretizer=cells)
    assert loaded[1].predict(observation) == runs[1].predict(observation)
    with pytest.raises(ValueError, match="is the function 'cells'"):
        qtab.load_runs(tmp_path / "runs.npz")[1].predict(observation)


@pytest.mark.slow
def test_a_store_knows_a_function_by_its_name(tmp_path: Path) -> None:
    settings: dict[str, Any] = {"shape": (19, 15), "episodes": 2, "max_episode_steps": 30, "seeds": 2}
    first, again = (
        qtab.sweep("MountainCar-v0", {"discount": [0.9]}, discretizer=cells, store=tmp_path / "s.db", **settings)
        for _ in range(2)
    )
    assert first.columns["final_return"].tolist() == again.columns["final_return"].tolist()
    with pytest.raises(qtab.StoreError, match="belongs to another sweep"):
        qtab.sweep("MountainCar-v0", {"discount": [0.9]}, discretizer=len, store=tmp_path / "s.db", **settings)


def test_a_mask_function_is_given_the_environments_own_observation() -> None:
    def mask(observation: Any) -> Any:
        assert isinstance(observation, dict)
        return np.array([True, observation["agent"][0] != 1, True, True])

    run = qtab.train(Tutorial(3), action_mask=mask, episodes=5, seed=0, max_episode_steps=50)
    assert run.action_masks is not None
    assert not run.action_masks[1][..., 1].all()  # those cells that were met
    assert run.action_masks[[0, 2]].all()
    assert qtab.verify(run, env=Tutorial(3)).equal
    by_function = qtab.train(
        Tutorial(3),
        discretizer=lambda o: (*o["agent"], *o["target"]),
        shape=(3, 3, 3, 3),
        action_mask=mask,
        episodes=5,
        seed=0,
        max_episode_steps=50,
    )
    assert by_function.tables.tobytes() == run.tables.tobytes()
    assert qtab.verify(by_function, env=Tutorial(3)).equal
