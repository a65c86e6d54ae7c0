"""A loaded run equals the saved one byte for byte, and a failed save leaves the old file."""

import dataclasses
import json
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import qtab
from support.environments import Walk
from support.ids import short_repr
from support.parity import assert_same_run, table_to_go_on_from
from support.processes.posix import posix_only


def fields(value):
    return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}


def assert_equal_runs(one, other):
    """Asserts that all fields are equal, types and dtypes included; recordings are not saved."""
    mine, theirs = fields(one), fields(other)
    for name in ("config", "discretizer", "actions"):
        np.testing.assert_equal(fields(theirs.pop(name)), fields(mine.pop(name)))
    del mine["recordings"], theirs["recordings"]
    np.testing.assert_equal(theirs, mine)
    assert_same_run(one, other)
    assert one.discretizer.low.dtype == other.discretizer.low.dtype
    assert type(other.config.seed) is int
    assert type(other.config.scale) is tuple


RUNS = {
    "plain": {"seed": 0},
    "a seed of 70 bits": {"seed": 2**69 + 1},
    "a seed of 200 bits": {"seed": 2**200 - 1},
    "MT19937": {"seed": 2**32 - 1, "bit_generator": "MT19937"},
    "a table to go on from": {"seed": 0, "initial_q": table_to_go_on_from()},
    "another range": {"seed": 0, "initial_q": (-0.1, 1 / 3)},
    "keyword arguments": {"seed": 0, "env_kwargs": {"goal_velocity": 0.1}},
    "gymnasium": {"seed": 0, "backend": "gymnasium", "max_episode_steps": 10},
    "recorded": {"seed": 0, "record": 2},
}


@pytest.mark.parametrize("settings", RUNS.values(), ids=RUNS)
def test_a_loaded_run_is_the_saved_one(tmp_path, settings):
    run = qtab.train("MountainCar-v0", episodes=5, **settings)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert_equal_runs(run, loaded)
    assert loaded.completed is True


def test_a_stopped_run_is_saved_as_stopped(tmp_path):
    run = qtab.train("MountainCar-v0", seed=0, callback=lambda progress: False)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(str(tmp_path / "run.npz"))
    assert_equal_runs(run, loaded)
    assert loaded.completed is False


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_run_of_a_users_own_environment_is_saved(tmp_path, dtype):
    run = qtab.train(Walk(dtype, start=5), scale=(3, 0.7), seed=0, episodes=5)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert_equal_runs(run, loaded)
    for observation in ([0.0, 0.0], [1.3, 2.9], [4.0, 4.0]):
        assert loaded.predict(observation) == run.predict(observation)


def test_a_saved_run_can_be_continued_and_repeated(tmp_path):
    run = qtab.train("MountainCar-v0", seed=0, episodes=20)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    settings: dict[str, Any] = dict(vars(loaded.config))
    assert_same_run(run, qtab.train(settings.pop("env"), **settings))
    on = [qtab.train("MountainCar-v0", seed=1, episodes=5, initial_q=table) for table in (run.q_table, loaded.q_table)]
    assert_same_run(*on)


def test_the_file_name_is_used_unchanged(tmp_path):
    run = qtab.train("MountainCar-v0", seed=0, episodes=1)
    for name in ("run", "run.data", "run.npz", "läufe 1.npz"):
        run.save(tmp_path / name)
        assert_equal_runs(run, qtab.load(tmp_path / name))
    assert len(list(tmp_path.iterdir())) == 4


def test_the_header_is_json_that_names_config_versions_and_timing(tmp_path):
    run = qtab.train("MountainCar-v0", seed=7, episodes=1)
    run.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as file:
        header = json.loads(str(file["header"]))
    assert header["config"]["seed"] == 7
    assert header["versions"]["numpy"] == np.__version__
    assert {"qtab", "gymnasium", "numpy", "python", "platform", "build"} <= set(header["versions"])
    assert header["seconds"] == run.seconds > 0.0


def test_a_save_replaces_the_file_that_was_there(tmp_path):
    path = tmp_path / "run.npz"
    qtab.train("MountainCar-v0", seed=0, episodes=30).save(path)
    run = qtab.train("MountainCar-v0", seed=1, episodes=1)
    run.save(path)
    assert_equal_runs(run, qtab.load(path))
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.npz"]


@posix_only
def test_a_failed_save_leaves_the_old_file_and_nothing_else(tmp_path):
    # In a process that may not write files of more than 8000 bytes.
    path = tmp_path / "run.npz"
    qtab.train("MountainCar-v0", seed=0, episodes=1).save(path)
    before = path.read_bytes()
    assert len(before) > 8000
    code = f"""
import resource, qtab
run = qtab.train("MountainCar-v0", seed=1, episodes=1)
resource.setrlimit(resource.RLIMIT_FSIZE, (8000, 8000))
try:
    run.save({str(path)!r})
except OSError as error:
    print(type(error).__name__, error.errno)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600)
    assert done.stdout.startswith("OSError")
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.npz"]


@pytest.mark.parametrize(
    ("value", "error"),
    [(np.float32(0.1), TypeError), (float("nan"), ValueError), (object(), TypeError), ({1: 2}, TypeError)],
    ids=short_repr,
)
def test_a_value_that_json_cannot_hold_is_refused_and_leaves_the_old_file(tmp_path, value, error):
    path = tmp_path / "run.npz"
    run = qtab.train("MountainCar-v0", seed=0, episodes=1)
    run.save(path)
    odd = dataclasses.replace(run, config=run.config.replace(env_kwargs={"goal_velocity": value}))
    with pytest.raises(error, match="env_kwargs must be JSON data"):
        odd.save(path)
    assert_equal_runs(run, qtab.load(path))
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.npz"]


def test_a_path_that_cannot_be_written_is_refused_by_name(tmp_path):
    run = qtab.train("MountainCar-v0", seed=0, episodes=1)
    (tmp_path / "file").write_text("no folder")
    for path, error in (
        (tmp_path / "missing" / "run.npz", FileNotFoundError),
        (tmp_path / "file" / "run.npz", NotADirectoryError),
        (tmp_path, IsADirectoryError),
    ):
        with pytest.raises(error) as caught:
            run.save(path)
        assert str(path) in str(caught.value)
    assert [entry.name for entry in tmp_path.iterdir()] == ["file"]


def test_a_missing_file_is_a_file_not_found(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"gone\.npz"):
        qtab.load(tmp_path / "gone.npz")
    with pytest.raises(OSError):
        qtab.load(tmp_path)
