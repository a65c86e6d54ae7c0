"""Nothing is ever unpickled from a file, and a file that is not a run is refused with a clear error.

Most of these files have no digest, so that what they hold is looked at; test_digest.py is about digests.
"""

import pickle
import zipfile
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab
from support.files.run_files import (
    assert_every_part_is_refused,
    load_with_flipped_bytes,
    members_of,
    with_header,
    without_digest,
)

REFUSED = "is not a run file that this version of qtab can read: "


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / "run.npz"
    qtab.train("MountainCar-v0", seed=0, episodes=4, initial_q=np.zeros((19, 15, 3))).save(path)
    return path


@pytest.fixture
def members(saved):
    return without_digest(members_of(saved))


class Marker:
    """Creates a file when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (open, (str(self.path), "w"))


def refused(path, message=""):
    with pytest.raises(ValueError, match=REFUSED) as caught:
        qtab.load(path)
    assert str(path) in str(caught.value)
    assert message in str(caught.value)


def test_a_truncated_file_is_refused(saved, tmp_path):
    assert_every_part_is_refused(saved, tmp_path / "cut.npz", refused)


@pytest.mark.parametrize("content", [b"", b"text", b"\x93NUMPY\x01\x00", b"PK\x03\x04" + 100 * b"\0", pickle.dumps({})])
def test_a_file_that_is_not_an_archive_is_refused(tmp_path, content):
    (tmp_path / "run.npz").write_bytes(content)
    refused(tmp_path / "run.npz")


@given(data=st.data())
def test_flipped_bytes_are_refused_or_change_nothing(saved, tmp_path_factory, data):
    path = tmp_path_factory.mktemp("flipped") / "run.npz"
    run = load_with_flipped_bytes(data, saved, path, qtab.load, REFUSED)
    if run is not None:
        assert run.tables.tobytes() == qtab.load(saved).tables.tobytes()


@pytest.mark.parametrize(
    "name", ["tables", "episode_returns", "terminated", "low", "scale", "initial_q", "header", "episode_lengths"]
)
def test_a_pickled_object_array_is_never_loaded(members, tmp_path, name):
    members[name] = np.array([Marker(tmp_path / "marker")], dtype=object)
    np.savez(tmp_path / "run.npz", **members)
    assert b"marker" in (tmp_path / "run.npz").read_bytes()
    refused(tmp_path / "run.npz", "allow_pickle")
    assert not (tmp_path / "marker").exists()


def test_a_pickle_with_our_extension_is_not_loaded(tmp_path):
    (tmp_path / "run.npz").write_bytes(pickle.dumps(Marker(tmp_path / "marker")))
    refused(tmp_path / "run.npz")
    assert not (tmp_path / "marker").exists()


def test_a_pickle_inside_the_archive_is_not_loaded(members, saved, tmp_path):
    path = tmp_path / "run.npz"
    with zipfile.ZipFile(saved) as source, zipfile.ZipFile(path, "w") as target:
        for entry in source.infolist():
            replaced = pickle.dumps(Marker(tmp_path / "marker"))
            target.writestr(entry.filename, replaced if entry.filename == "tables.npy" else source.read(entry))
    refused(path)
    assert not (tmp_path / "marker").exists()


def test_a_compressed_file_is_refused_before_decompression(members, tmp_path):
    np.savez_compressed(tmp_path / "run.npz", **members)
    refused(tmp_path / "run.npz", "compressed")


def test_a_decompression_bomb_is_refused(saved, tmp_path):
    path = tmp_path / "run.npz"
    with zipfile.ZipFile(saved) as source, zipfile.ZipFile(path, "w") as target:
        for entry in source.infolist():
            if entry.filename == "tables.npy":
                target.writestr(entry.filename, bytes(10**8), compress_type=zipfile.ZIP_DEFLATED)
            else:
                target.writestr(entry.filename, source.read(entry))
    assert path.stat().st_size < 10**6
    refused(path, "compressed")


@pytest.mark.parametrize("shape", [(1, 2**40, 3), (1, 2**28, 3), (2**62, 2**62, 2**62), (-1, 285, 3), (1, 286, 3)])
def test_a_declared_shape_beyond_the_data_is_refused(saved, tmp_path, shape):
    path = tmp_path / "run.npz"
    with zipfile.ZipFile(saved) as source, zipfile.ZipFile(path, "w") as target:
        for entry in source.infolist():
            content = source.read(entry)
            if entry.filename == "tables.npy":
                text = repr({"descr": "<f8", "fortran_order": False, "shape": shape}).encode().ljust(117) + b"\n"
                content = b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + content[128:]
            target.writestr(entry.filename, content)
    refused(path)


@pytest.mark.parametrize("name", ["tables", "episode_returns", "episode_lengths", "terminated", "low", "high", "scale"])
def test_a_missing_array_is_named(members, tmp_path, name):
    del members[name]
    np.savez(tmp_path / "run.npz", **members)
    refused(tmp_path / "run.npz", name)


WRONG_ARRAYS = {
    "float32 tables": ("tables", lambda array: array.astype(np.float32)),
    "flat tables": ("tables", np.ravel),
    "no tables": ("tables", lambda array: array[:0]),
    "tables of fewer rows": ("tables", lambda array: array[:, :-1]),
    "tables of other rows": ("tables", lambda array: array.reshape(1, 171, 5)),
    "tables of complex numbers": ("tables", lambda array: array + 1j),
    "big-endian tables": ("tables", lambda array: array.astype(">f8")),
    "lengths as floats": ("episode_lengths", lambda array: array.astype(float)),
    "fewer lengths": ("episode_lengths", lambda array: array[:-1]),
    "more episodes": ("episode_returns", lambda array: np.repeat(array, 2)),
    "terminated as integers": ("terminated", lambda array: array.astype(int)),
    "bounds of another length": ("low", lambda array: array[:1]),
    "bounds that are not finite": ("high", lambda array: array * np.float32(np.inf)),
    "bounds that are nan": ("low", lambda array: array * np.float32(np.nan)),
    "bounds as integers": ("low", lambda array: np.array([-1, 0])),
    "bounds of two dtypes": ("high", lambda array: array.astype(np.float64)),
    "bounds in half precision": ("low", lambda array: array.astype(np.float16)),
    "a scale that is not the config's": ("scale", lambda array: array[::-1].copy()),
    "a huge scale": ("scale", lambda array: array * 1e300),
    "a first table of another shape": ("initial_q", lambda array: array[:-1]),
    "a first table with nan": ("initial_q", lambda array: array * np.nan),
    "a text as bounds": ("low", lambda array: np.array(["a", "b"])),
}


@pytest.mark.parametrize(("name", "change"), WRONG_ARRAYS.values(), ids=WRONG_ARRAYS)
def test_an_array_that_does_not_fit_is_refused(members, tmp_path, name, change):
    members[name] = change(members[name])
    np.savez(tmp_path / "run.npz", **members)
    refused(tmp_path / "run.npz")


def config(**changes):
    return lambda header: header["config"].update(changes)


WRONG_HEADERS = {
    "another version": (lambda header: header.update(version=999), "version 999"),
    "no version": (lambda header: header.pop("version"), "version"),
    "another format": (lambda header: header.update(format="something else"), "header"),
    "no config": (lambda header: header.pop("config"), "config"),
    "a config that is a list": (lambda header: header.update(config=[1]), ""),
    "an unknown setting": (config(colour="red"), "colour"),
    "a setting out of range": (config(epsilon=2.0), "epsilon must lie in [0, 1], got 2.0"),
    "a setting of another type": (config(episodes="many"), "episodes"),
    "a seed that was left open": (config(seed=None), "config"),
    "a limit that was left open": (config(max_episode_steps=None), "config"),
    "an endless epsilon": (config(epsilon=float("inf")), "epsilon"),
    "fewer episodes than there are": (config(episodes=3), "episodes"),
    "a run that says it is complete": (config(episodes=5), "episodes"),
    "infinitely many actions": (lambda header: header.update(actions=float("inf")), ""),
    "no actions": (lambda header: header.update(actions=0), ""),
    "minus three actions": (lambda header: header.update(actions=-3), ""),
    "actions as text": (lambda header: header.update(actions="three"), ""),
    "versions as a list": (lambda header: header.update(versions=["1"]), ""),
    "seconds as text": (lambda header: header.update(seconds="long"), ""),
}


@pytest.mark.parametrize(("change", "message"), WRONG_HEADERS.values(), ids=WRONG_HEADERS)
def test_a_header_that_does_not_fit_is_refused(members, tmp_path, change, message):
    np.savez(tmp_path / "run.npz", **with_header(members, change))
    refused(tmp_path / "run.npz", message)


@pytest.fixture(scope="module")
def few_actions(tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / "run.npz"
    chosen: dict[str, Any] = {"discretizer": "bins", "bins": (4, 3, 5), "actions": (-1.0, 0.5)}
    qtab.train("Pendulum-v1", seed=0, episodes=2, max_episode_steps=9, initial_q=0.0, **chosen).save(path)
    return without_digest(members_of(path))


WRONG_BINS = {
    "more bins": config(bins=[4, 3, 6]),
    "the same rows otherwise": config(bins=[4, 15]),
    "bins without end": config(bins=[1_000_000] * 400),
    "bins left open": config(bins=None),
    "limits left open": config(low=None),
    "limits the wrong way round": config(low=[1.0, 1.0, 8.0], high=[-1.0, -1.0, -8.0]),
    "limits of another length": config(low=[-1.0, -1.0], high=[1.0, 1.0]),
    "limits beyond float32": config(low=[-1e300] * 3, high=[1e300] * 3),
    "other actions": config(actions=[-1.0, 0.25]),
    "more actions": config(actions=[-1.0, 0.5, 1.0]),
    "another number of actions": config(actions=3),
    "no actions": config(actions=None),
    "edges, too": config(edges=[[0.0], [0.0], [0.0]]),
    "edges instead": config(edges=[[0.0], [0.0], [0.0]], discretizer="edges", bins=None, low=None, high=None),
}


@pytest.mark.parametrize("change", WRONG_BINS.values(), ids=WRONG_BINS)
def test_bins_and_actions_that_do_not_fit_are_refused(few_actions, tmp_path, change):
    np.savez(tmp_path / "run.npz", **few_actions)
    assert qtab.load(tmp_path / "run.npz").actions.count == 2
    np.savez(tmp_path / "run.npz", **with_header(few_actions, change))
    refused(tmp_path / "run.npz")


@pytest.mark.parametrize(
    "actions",
    [
        None,
        np.zeros(2),
        np.array([[-1.0, 0.5]]),
        np.array([[-1.0], [np.nan]]),
        np.array([[-1], [1]]),
        np.zeros((2, 0), np.float32),
        np.array(["a", "b"]),
    ],
    ids=repr,
)
def test_an_array_of_actions_that_does_not_fit_is_refused(few_actions, tmp_path, actions):
    changed = {name: array for name, array in few_actions.items() if name != "actions"}
    np.savez(tmp_path / "run.npz", **changed | ({} if actions is None else {"actions": actions}))
    refused(tmp_path / "run.npz", "actions")


HEADERS = {
    "half": np.array("{"),
    "a list": np.array("[1]"),
    "a number": np.array("7"),
    "bytes": np.array(b"{}"),
    "zeros": np.zeros(3),
    "two": np.array(["{}", "{}"]),
    "nested without end": np.array("[" * 99_999),
}


@pytest.mark.parametrize("header", HEADERS.values(), ids=HEADERS)
def test_a_header_that_is_not_a_json_object_is_refused(members, tmp_path, header):
    np.savez(tmp_path / "run.npz", **members | {"header": header})
    refused(tmp_path / "run.npz")


def test_an_archive_of_something_else_is_refused(tmp_path):
    np.savez(tmp_path / "run.npz", weights=np.zeros(3))
    refused(tmp_path / "run.npz", "header")
    np.save(tmp_path / "run.npy", np.zeros(3))
    refused(tmp_path / "run.npy")
