"""Whatever is done to a run file, it loads as the run that was saved, or is refused by the one documented error.

More examples: python -m pytest tests/results/files/test_run_file_fuzz.py --hypothesis-profile fuzz
"""

import dataclasses
import io
import struct
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gymnasium.spaces import Box, Dict, Discrete
from hypothesis import event, given
from hypothesis import strategies as st

import qtab
from support.environments import Sampled
from support.files.run_files import members_of, with_header, with_right_digest, without_digest

REFUSED = "is not a run file that this version of qtab can read: "

Draw = Callable[[st.SearchStrategy[Any]], Any]


MIXED = Dict({"room": Discrete(3), "speed": Box(-1.0, 1.0, (2,))})
SHORT: dict[str, Any] = {"seed": 4, "episodes": 2, "max_episode_steps": 10}


def saved_runs() -> dict[str, qtab.Run]:
    initial_q = np.zeros((16, 4))
    initial_q[2, 3] = -np.inf
    return {
        "cells": qtab.train("MountainCar-v0", seed=0, episodes=3, env_kwargs={"goal_velocity": 0.01}),
        "missing actions": qtab.train("FrozenLake-v1", seed=1, episodes=3, initial_q=initial_q, algorithm="sarsa"),
        "a Box of actions": qtab.train("Pendulum-v1", seed=2, episodes=2, max_episode_steps=5, preset=None),
        "tiles": qtab.train("MountainCar-v0", seed=3, episodes=2, preset="solved", tiles=2, tilings=2),
        "a mapping": qtab.train(Sampled(MIXED), discretizer={"speed": "bins"}, **SHORT),
        "rows that were met": qtab.train(Sampled(MIXED), scale=(2, 3), max_rows=50, **SHORT),
    }


RUNS = saved_runs()


@pytest.fixture(scope="module")
def contents(tmp_path_factory) -> dict[str, bytes]:
    path = tmp_path_factory.mktemp("saved") / "run.npz"
    written = {}
    for name, run in RUNS.items():
        run.save(path)
        written[name] = path.read_bytes()
    return written


def outcome(content: bytes, folder: Path) -> qtab.Run | None:
    """The run that a file loads as, or None if it is refused as documented; anything else fails the test."""
    path = folder / "run.npz"
    path.write_bytes(content)
    try:
        return qtab.load(path)
    except ValueError as error:
        if not str(error).startswith(f"{str(path)!r} {REFUSED}"):
            raise
        return None


def assert_equal(loaded: qtab.Run, run: qtab.Run) -> None:
    """Asserts that two runs are equal in everything that is saved, types and dtypes included."""
    assert loaded.config == run.config
    assert dict(loaded.versions) == dict(run.versions)
    assert (loaded.completed, loaded.seconds, loaded.unchecked) == (run.completed, run.seconds, False)
    assert (loaded.actions.count, loaded.actions.first) == (run.actions.count, run.actions.first)
    arrays = ["tables", "episode_returns", "episode_lengths", "terminated"]
    pairs = [(getattr(loaded, name), getattr(run, name)) for name in arrays]
    pairs += [(loaded.actions.values, run.actions.values)] if run.actions.values is not None else []
    assert type(loaded.discretizer) is type(run.discretizer)
    if run.discretizer.reads_space:
        assert loaded.discretizer.spec() == run.discretizer.spec()
        stored, expected = loaded.discretizer.arrays(), run.discretizer.arrays()
        assert stored.keys() == expected.keys()
        pairs += [(stored[name], array) for name, array in expected.items()]
    for field in () if run.discretizer.reads_space else dataclasses.fields(run.discretizer):
        one, other = (getattr(each.discretizer, field.name) for each in (loaded, run))
        pairs += zip(one, other, strict=True) if isinstance(one, tuple) else [(one, other)]
    for one, other in pairs:
        one, other = np.asarray(one), np.asarray(other)
        assert (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())


def flip(content: bytes, draw: Draw) -> bytes:
    changed = bytearray(content)
    for _ in range(draw(st.integers(1, 8))):
        changed[draw(st.integers(0, len(changed) - 1))] ^= draw(st.integers(1, 255))
    return bytes(changed)


def cut(content: bytes, draw: Draw) -> bytes:
    start, stop = sorted(draw(st.tuples(*[st.integers(0, len(content))] * 2)))
    return content[:start] + content[stop:] if draw(st.booleans()) else content[start:stop]


def splice(content: bytes, draw: Draw) -> bytes:
    start, stop, place = draw(st.tuples(*[st.integers(0, len(content))] * 3))
    return content[:place] + (content[start:stop] or draw(st.binary(max_size=64))) + content[place:]


def set_number(content: bytes, draw: Draw) -> bytes:
    """Writes a length, an offset or a checksum of the archive anew."""
    signature = draw(st.sampled_from([b"PK\x01\x02", b"PK\x03\x04", b"PK\x05\x06"]))
    places = [place for place in range(len(content)) if content.startswith(signature, place)]
    at = draw(st.sampled_from(places)) + draw(st.integers(4, 42))
    number = struct.pack(
        "<I", draw(st.sampled_from([0, 1, 8, 2**16, 2**31 - 1, 2**32 - 1]) | st.integers(0, 2**32 - 1))
    )
    return content[:at] + number + content[at + 4 :]


def rezip(content: bytes, draw: Draw) -> bytes:
    """Drops, swaps, repeats, renames, compresses or replaces members."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = [(entry.filename, archive.read(entry)) for entry in archive.infolist()]
    one, other = (draw(st.integers(0, len(members) - 1)) for _ in range(2))
    change = draw(st.sampled_from(["drop", "swap", "repeat", "rename", "compress", "replace", "reorder", "foreign"]))
    compression = zipfile.ZIP_STORED
    if change == "drop":
        del members[one]
    elif change == "swap":
        (name, data), (other_name, other_data) = members[one], members[other]
        members[one], members[other] = (name, other_data), (other_name, data)
    elif change == "rename":
        members[one] = (draw(st.sampled_from(["digest.npy", "x.npy", "../x.npy", "tables", ""])), members[one][1])
    elif change == "compress":
        compression = draw(st.sampled_from([zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]))
    elif change == "replace":
        members[one] = (members[one][0], draw(st.binary(max_size=200)))
    elif change == "reorder":
        members = draw(st.permutations(members))
    elif change == "foreign":
        members.append((draw(st.text(max_size=5)), draw(st.binary(max_size=50))))
    elif change == "repeat":
        members.append((members[one][0], members[other][1]))
    written = io.BytesIO()
    with warnings.catch_warnings(), zipfile.ZipFile(written, "w") as archive:
        warnings.simplefilter("ignore")  # two members of the same name
        for name, data in members:
            archive.writestr(zipfile.ZipInfo(name), data, compression)
    return written.getvalue()


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.just(10**400),
    lambda part: st.lists(part, max_size=4) | st.dictionaries(st.text(max_size=8), part, max_size=4),
    max_leaves=6,
)


def change_json(header: dict[str, Any], draw: Draw) -> None:
    """Removes, sets or renames a key of the header, of its config, or of its versions."""
    parts = [part for part in (header.get("config"), header, header.get("versions")) if isinstance(part, dict) and part]
    if not parts:
        return
    inner = draw(st.sampled_from(parts))
    key = draw(st.sampled_from(sorted(inner)))
    change = draw(st.sampled_from(["remove", "set", "rename", "nest", "swap"]))
    if change == "remove":
        del inner[key]
    elif change == "set":
        inner[key] = draw(JSON)
    elif change == "rename":
        inner[draw(st.text(max_size=8))] = inner.pop(key)
    elif change == "nest":
        inner[key] = [inner[key]] * draw(st.integers(0, 3))
    else:
        other = draw(st.sampled_from(sorted(inner)))
        inner[key], inner[other] = inner[other], inner[key]


def edit_header(content: bytes, draw: Draw) -> bytes:
    members = members_of(io.BytesIO(content))  # type: ignore[arg-type]
    for _ in range(draw(st.integers(1, 3))):
        members = with_header(members, lambda header: change_json(header, draw))
    return packed(members)


def edit_array(content: bytes, draw: Draw) -> bytes:
    members = members_of(io.BytesIO(content))  # type: ignore[arg-type]
    name = draw(st.sampled_from(sorted(set(members) - {"header", "digest"})))
    flat = members[name].reshape(-1).view(np.uint8)
    flat[draw(st.integers(0, len(flat) - 1))] ^= draw(st.integers(1, 255))
    return packed(members)


def packed(members: dict[str, Any]) -> bytes:
    written = io.BytesIO()
    np.savez(written, **members)
    return written.getvalue()


MUTATIONS = {each.__name__: each for each in (flip, cut, splice, set_number, rezip, edit_header, edit_array)}


@given(data=st.data())
def test_a_mutated_file_is_the_saved_run_or_is_refused(contents, tmp_path_factory, data):
    name = data.draw(st.sampled_from(sorted(RUNS)))
    content = MUTATIONS[data.draw(st.sampled_from(sorted(MUTATIONS)))](contents[name], data.draw)
    if content and data.draw(st.booleans()):
        content = data.draw(st.sampled_from([flip, cut, splice]))(content, data.draw)
    loaded = outcome(content, tmp_path_factory.mktemp("mutated"))
    event("refused" if loaded is None else "loaded")
    if loaded is not None:
        assert_equal(loaded, RUNS[name])


@pytest.mark.slow
@given(data=st.data())
def test_a_file_that_is_only_checked_for_its_meaning_is_a_possible_run_or_is_refused(contents, tmp_path_factory, data):
    name = data.draw(st.sampled_from(sorted(RUNS)))
    members = members_of(io.BytesIO(contents[name]))  # type: ignore[arg-type]
    members = with_header(members, lambda header: change_json(header, data.draw))
    finish = data.draw(st.sampled_from([without_digest, with_right_digest]))
    try:
        content = packed(finish(members))
    except (ValueError, KeyError):
        return  # a header that has no digest to take away, or that JSON cannot hold
    loaded = outcome(content, tmp_path_factory.mktemp("mutated"))
    event("refused" if loaded is None else "loaded")
    if loaded is not None:
        assert np.isfinite(loaded.tables).sum() + np.isneginf(loaded.tables).sum() == loaded.tables.size
        assert len(loaded.episode_returns) <= loaded.config.episodes
        assert len(repr(loaded)) > 0
        assert len(loaded._repr_html_()) < 20_000
