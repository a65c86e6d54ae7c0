"""The format of saved runs: one uncompressed ``.npz`` file of arrays and a JSON header, never a pickle.

``file_parts.write`` composes the header, of settings, actions and versions, and adds the optional arrays.
"""

import hashlib
import json
import math
import os
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from qtab._utils.files import replacing

RUN, RUNS = "qtab run", "qtab runs"
"""The formats of one run, and of many runs of one config."""
FORMAT_VERSION = 1
_ADVICE = {RUN: "it holds one run, which qtab.load reads", RUNS: "it holds many runs, which qtab.load_runs reads"}

ARRAYS: Mapping[str, tuple["np.dtype[Any]", int]] = {
    "tables": (np.dtype(np.float64), 3),
    "episode_returns": (np.dtype(np.float64), 1),
    "episode_lengths": (np.dtype(np.int64), 1),
    "terminated": (np.dtype(np.bool_), 1),
}
"""The dtype and number of axes of the arrays that every run has; files of many runs have one more axis."""

_HEADER, _DIGEST = "header", "digest"
_ALGORITHM = "sha256"


@dataclass(frozen=True)
class Content:
    """The content of a file: a header and arrays that belong together, otherwise unchecked."""

    header: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]]
    has_digest: bool
    """Whether the file had a digest, which then matched. Files of earlier versions have none."""


def digest(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> str:
    """Returns the digest of a saved run as hexadecimal digits: equal only for the same header and the same arrays.

    It is the SHA-256 of a JSON text, with sorted keys and no spaces, of the header and of each array's dtype and shape,
    followed by the bytes of the arrays in C order, sorted by name. The text determines the number of bytes that follow.

    Args:
        header: The header as ``json.loads`` returns it, so that it has the same digest when written and when read.
        arrays: The arrays by name, without the header.

    Raises:
        ValueError: if the header holds a number that JSON cannot represent.
    """
    layouts = {name: [array.dtype.str, list(array.shape)] for name, array in arrays.items()}
    text = json.dumps({"header": header, "arrays": layouts}, sort_keys=True, separators=(",", ":"), allow_nan=False)
    computed = hashlib.new(_ALGORITHM, text.encode())
    for name in sorted(arrays):
        computed.update(np.ascontiguousarray(arrays[name]).reshape(-1).view(np.uint8).data)
    return computed.hexdigest()


def encode(header: Mapping[str, Any], kind: str = RUN) -> str:
    """Returns a header as JSON, with the name and version of the format, and a note that the file has a digest.

    Raises:
        TypeError: if the header is not JSON data.
        ValueError: if the header holds a number that JSON cannot represent.
    """
    content = {"format": kind, "version": FORMAT_VERSION, _DIGEST: _ALGORITHM, **header}
    return json.dumps(content, allow_nan=False)


def write(path: Path, header: str, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Writes a file, completely or not at all.

    Raises:
        OSError: if the file cannot be written.
    """
    checked = np.array(digest(json.loads(header), arrays))
    members: dict[str, Any] = {_HEADER: np.array(header), _DIGEST: checked, **arrays}
    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **members)


def read(file: BinaryIO, kind: str = RUN) -> Content:
    """Reads a file, and compares its digest if it has one.

    Raises:
        ValueError: if it is not a file of this kind, comes from another version of the format, or was changed after it
            was saved. A damaged file can raise almost any other exception.
    """
    with zipfile.ZipFile(file) as archive:
        entries = archive.infolist()
        # An uncompressed array is no larger than its file, so a small file cannot allocate much memory.
        if any(entry.compress_type != zipfile.ZIP_STORED for entry in entries):
            raise ValueError("it is compressed, which qtab's files are not")
        if sum(entry.file_size for entry in entries) > file.seek(0, os.SEEK_END):
            raise ValueError("its arrays are larger than the file")
        names = [entry.filename.removesuffix(".npy") for entry in entries]
        if len(set(names)) < len(names):
            raise ValueError("it has two arrays of the same name")
        arrays = {name: _read_array(archive, entry) for name, entry in zip(names, entries, strict=True)}
    header = _header(arrays.pop(_HEADER), kind)
    stored = arrays.pop(_DIGEST, None)
    if (stored is None) != (_DIGEST not in header):
        raise ValueError("its digest is missing")
    if stored is not None and (header[_DIGEST] != _ALGORITHM or str(stored) != digest(header, arrays)):
        raise ValueError("its digest is not that of its content, which was changed after it was saved")
    return Content(header, arrays, has_digest=stored is not None)


def _header(stored: NDArray[Any], kind: str) -> dict[str, Any]:
    header: Any = json.loads(str(stored), object_pairs_hook=_without_duplicates)
    found = header.get("format") if isinstance(header, dict) else None
    if found != kind:
        advice = _ADVICE.get(found) if isinstance(found, str) else None
        raise ValueError(advice or "its header is not one of qtab's")
    if header["version"] != FORMAT_VERSION:
        raise ValueError(f"its format has version {header['version']!r}, this one reads {FORMAT_VERSION}")
    checked: dict[str, Any] = header
    return checked


def _without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("its header has two values for the same name")
    return found


def _read_array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> NDArray[Any]:
    """Reads an array if its size is that of its member, so that no more memory than the file's size is allocated."""
    with archive.open(entry) as file:
        read_header = npy.read_array_header_1_0 if npy.read_magic(file) == (1, 0) else npy.read_array_header_2_0
        shape, _, dtype = read_header(file)
        size = entry.file_size - file.tell()
        if not dtype.hasobject and math.prod(shape) * dtype.itemsize != size:
            raise ValueError(f"its {entry.filename} has shape {shape}, which does not fit its size")
    with archive.open(entry) as file:
        read: NDArray[Any] = npy.read_array(file, allow_pickle=False)
        return read


def array(arrays: Mapping[str, NDArray[Any]], name: str, more_axes: int = 0) -> NDArray[Any]:
    """Returns one of ``ARRAYS``, with ``more_axes`` additional axes.

    Raises:
        KeyError: if the array is missing.
        ValueError: if the array has a different dtype or number of axes.
    """
    dtype, ndim = ARRAYS[name][0], ARRAYS[name][1] + more_axes
    found = arrays[name]
    if found.dtype != dtype or found.ndim != ndim:
        raise ValueError(f"its {name} has dtype {found.dtype} and {found.ndim} axes, not {dtype} and {ndim}")
    return found
