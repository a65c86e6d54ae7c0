"""The members of a run file, to be changed and written again."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

from qtab.results.files.run_file import digest

Members = dict[str, Any]


def members_of(path: Path) -> Members:
    """The arrays of a run file by name: its header and its digest are texts."""
    with np.load(path) as file:
        return dict(file)


def with_header(members: Members, change: Callable[[dict[str, Any]], Any]) -> Members:
    """The same members with a changed header; the digest is not computed again."""
    header = json.loads(str(members["header"]))
    change(header)
    return members | {"header": np.array(json.dumps(header))}


def without_digest(members: Members) -> Members:
    """As versions without digests wrote them: what the parts mean is then all that can be checked."""
    kept = {name: array for name, array in members.items() if name != "digest"}
    return with_header(kept, lambda header: header.pop("digest"))


def with_right_digest(members: Members) -> Members:
    """With the digest of what they hold now, as someone would compute it who wants a file to be believed."""
    arrays = {name: array for name, array in members.items() if name not in ("header", "digest")}
    return members | {"digest": np.array(digest(json.loads(str(members["header"])), arrays))}


def write_members(path: Path, members: Mapping[str, Any]) -> None:
    """Writes a run file."""
    np.savez(path, **members)


def assert_every_part_is_refused(saved: Path, cut: Path, refused: Callable[[Path], None]) -> None:
    """Writes beginnings of a file, more of them around its first and last bytes, each of which must be refused."""
    whole = saved.read_bytes()
    for length in [*range(0, 80), *range(80, len(whole), 97), *range(len(whole) - 80, len(whole))]:
        cut.write_bytes(whole[:length])
        refused(cut)


def load_with_flipped_bytes(data: st.DataObject, saved: Path, path: Path, load: Callable[[Path], Any], why: str) -> Any:
    """What a file with a few changed bytes loads as; None where it is refused, with ``why`` in the message."""
    whole = bytearray(saved.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        whole[data.draw(st.integers(0, len(whole) - 1))] ^= data.draw(st.integers(1, 255))
    path.write_bytes(whole)
    try:
        return load(path)
    except ValueError as error:
        if why not in str(error):
            raise
        return None
