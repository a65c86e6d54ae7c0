"""Many runs in one file: they load as they were saved, to the bit, or are refused with a clear error."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab
from support.files.run_files import (
    Members,
    assert_every_part_is_refused,
    load_with_flipped_bytes,
    members_of,
    with_header,
    with_right_digest,
    without_digest,
    write_members,
)

REFUSED = "is not a file of runs that this version of qtab can read: "

MISSING = np.zeros((16, 4))
MISSING[2, 3] = -np.inf
SETTINGS: dict[str, dict[str, Any]] = {
    "cells": {"env": "MountainCar-v0", "env_kwargs": {"goal_velocity": 0.01}},
    "missing actions": {"env": "FrozenLake-v1", "initial_q": MISSING, "algorithm": "sarsa"},
    "two tables": {"env": "Blackjack-v1", "algorithm": "double_q_learning"},
    "a Box of actions": {"env": "Pendulum-v1", "max_episode_steps": 5},
    "tiles": {"env": "MountainCar-v0", "preset": "solved", "tiles": 2, "tilings": 2},
    "edges": {"env": "CartPole-v1", "discretizer": "edges", "edges": [[0], [0, 1], [0], [0.1]]},
}


def assert_same(one: qtab.Runs, other: qtab.Runs) -> None:
    """Asserts that runs are equal in all that they hold, dtypes included."""
    for field in dataclasses.fields(qtab.Runs):
        a, b = getattr(one, field.name), getattr(other, field.name)
        if isinstance(a, np.ndarray):
            assert (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes()), field.name
        elif field.name == "discretizer":
            assert type(a) is type(b)
            assert a.shape == b.shape
            assert {name: array.tobytes() for name, array in a.arrays().items()} == {
                name: array.tobytes() for name, array in b.arrays().items()
            }
        elif field.name == "actions":
            assert (a.count, a.first) == (b.count, b.first)
            assert np.array_equal(a.values, b.values) if a.values is not None else b.values is None
        else:
            assert a == b, field.name
            assert type(a) is type(b)


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS)
@pytest.mark.parametrize("tables", [True, False])
def test_they_load_as_they_were_saved(tmp_path, settings, tables):
    runs = qtab.train_many(seeds=[3, 0, 2**70], episodes=3, tables=tables, **settings)
    runs.save(tmp_path / "runs.npz")
    loaded = qtab.load_runs(str(tmp_path / "runs.npz"))
    assert_same(loaded, runs)
    assert_same(loaded[:2], runs[:2])
    loaded.save(tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == (tmp_path / "runs.npz").read_bytes()
    if tables:
        observation = qtab.train(**settings, episodes=1).discretizer.low
        assert loaded[1].predict(observation)[0] == runs[1].predict(observation)[0]


def test_slices_and_interrupted_runs_are_saved_too(tmp_path):
    saved: list[int] = []

    def keep(progress: qtab.RunsProgress) -> bool:
        progress.finished.save(tmp_path / "part.npz")
        saved.append(progress.runs)
        return progress.runs < 4

    runs = qtab.train_many("FrozenLake-v1", 9, episodes=4, tables=True, callback=keep, callback_every=2)
    assert saved == [2, 4]
    part = qtab.load_runs(tmp_path / "part.npz")
    assert_same(part, dataclasses.replace(runs, seconds=part.seconds))
    assert (part.completed, part.seeds) == (False, (0, 1, 2, 3))
    for index in (slice(None, None, -2), slice(2, 2)):
        runs[index].save(tmp_path / "slice.npz")
        assert_same(qtab.load_runs(tmp_path / "slice.npz"), runs[index])


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / "runs.npz"
    qtab.train_many("FrozenLake-v1", [4, 7], episodes=5, tables=True).save(path)
    return path


def refused(path: Any, message: str = "") -> None:
    with pytest.raises(ValueError, match=REFUSED) as caught:
        qtab.load_runs(path)
    assert str(path) in str(caught.value)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_one_run_and_many_are_told_apart(saved, tmp_path):
    with pytest.raises(ValueError, match=r"can read: it holds many runs, which qtab\.load_runs reads$"):
        qtab.load(saved)
    qtab.train("FrozenLake-v1", seed=0, episodes=2).save(tmp_path / "run.npz")
    refused(tmp_path / "run.npz", "it holds one run, which qtab.load reads")
    qtab.train("FrozenLake-v1", seed=0, episodes=2).save(saved.with_name("other.npz"))
    with pytest.raises(FileNotFoundError):
        qtab.load_runs(tmp_path / "none.npz")
    with pytest.raises(TypeError):
        qtab.load_runs(3)  # type: ignore[arg-type]


def test_a_truncated_file_is_refused(saved, tmp_path):
    assert_every_part_is_refused(saved, tmp_path / "cut.npz", refused)


@given(data=st.data())
def test_flipped_bytes_are_refused_or_change_nothing(saved, tmp_path_factory, data):
    path = tmp_path_factory.mktemp("flipped") / "runs.npz"
    runs = load_with_flipped_bytes(data, saved, path, qtab.load_runs, REFUSED)
    if runs is not None:
        assert_same(runs, qtab.load_runs(saved))


Change = Callable[[Members], Members]


def header(**changes: Any) -> Change:
    return lambda members: with_header(members, lambda found: found.update(changes))


def config(**changes: Any) -> Change:
    return lambda members: with_header(members, lambda found: found["config"].update(changes))


def array(name: str, change: Callable[[Any], Any]) -> Change:
    return lambda members: members | {name: change(members[name])}


def last(value: float) -> Callable[[Any], Any]:
    return lambda found: np.concatenate([found.ravel()[:-1], [value]]).astype(found.dtype).reshape(found.shape)


IMPOSSIBLE: dict[str, tuple[Change, str]] = {
    "the same seed twice": (header(seeds=[4, 4]), "its seeds must be different integers"),
    "a negative seed": (header(seeds=[4, -1]), "its seeds must be different integers"),
    "seeds that are texts": (header(seeds=["4", "7"]), "its seeds must be different integers"),
    "seeds that are true": (header(seeds=[True, 0]), "its seeds must be different integers"),
    "seeds that are no list": (header(seeds=3), "its seeds must be a list, got 3"),
    "a seed too many": (header(seeds=[4, 7, 8]), "its episodes must be those of 3 seeds, 5 each"),
    "more episodes": (config(episodes=6), "its episodes must be those of 2 seeds, 6 each"),
    "completed as a number": (header(completed=1), "its completed must be true or false, got 1"),
    "rows as a text": (header(rows="16"), "its number of rows must be an integer"),
    "negative seconds": (header(seconds=-1.0), "its seconds must be finite and not negative"),
    "another format": (header(format="qtab sweep"), "its header is not one of qtab's"),
    "another version": (header(version=2), "its format has version 2, this one reads 1"),
    "an episode without steps": (array("episode_lengths", last(0)), "its episode_lengths must lie between 1 and 100"),
    "a return that is nan": (array("episode_returns", last(np.nan)), "its episode_returns must be finite"),
    "a value that is infinite": (array("tables", last(np.inf)), "its tables must be finite"),
    "the tables of one run": (array("tables", lambda found: found[:1]), "its tables have shape (1, 1, 16, 4)"),
    "tables with an axis less": (array("tables", lambda found: found[0]), "its tables has dtype float64 and 3 axes"),
    "float32 returns": (array("episode_returns", lambda found: found.astype(np.float32)), "has dtype float32"),
    "no lengths": (lambda members: {k: v for k, v in members.items() if k != "episode_lengths"}, "'episode_lengths'"),
    "more rows than a table has": (header(rows=10**600), "its number of rows must be less than 2**32"),
    "other rows than its bins": (
        config(discretizer="bins", bins=[10**6] * 2, low=[0.0] * 2, high=[1.0] * 2),
        "its table has another number of rows than its bins",
    ),
}


@pytest.mark.parametrize(("change", "message"), IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_what_cannot_be_is_refused_even_with_the_right_digest(saved, tmp_path, change, message):
    write_members(tmp_path / "changed.npz", change(members_of(saved)))
    refused(tmp_path / "changed.npz")
    write_members(tmp_path / "changed.npz", with_right_digest(change(members_of(saved))))
    refused(tmp_path / "changed.npz", message.replace("between 1 and 100", "between 1 and max_episode_steps = 100"))


def test_a_digest_is_required(saved, tmp_path):
    write_members(tmp_path / "old.npz", without_digest(members_of(saved)))
    refused(tmp_path / "old.npz", "its digest is missing")


def test_a_compressed_file_and_a_pickle_are_refused(saved, tmp_path):
    members = members_of(saved)
    np.savez_compressed(tmp_path / "runs.npz", **members)
    refused(tmp_path / "runs.npz", "compressed")
    np.savez(tmp_path / "runs.npz", **members | {"tables": np.array([open], dtype=object)})
    refused(tmp_path / "runs.npz", "allow_pickle")


def test_what_training_does_not_return_is_not_saved(tmp_path):
    runs = qtab.train_many("FrozenLake-v1", 2, episodes=3, tables=True)
    assert runs.tables is not None
    runs.tables[0, 0, 0, 0] = np.nan
    with pytest.raises(ValueError, match=r"^these runs cannot be saved: its tables must be finite"):
        runs.save(tmp_path / "runs.npz")
    assert list(tmp_path.iterdir()) == []
