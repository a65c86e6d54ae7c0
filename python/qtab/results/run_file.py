"""The format of a saved run: one uncompressed ``.npz`` file of arrays and a JSON header, never a pickle."""

import json
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from qtab._utils.files import replacing

FORMAT = "qtab run"
FORMAT_VERSION = 1

ARRAYS: Mapping[str, tuple["np.dtype[Any]", int]] = {
    "tables": (np.dtype(np.float64), 3),
    "episode_returns": (np.dtype(np.float64), 1),
    "episode_lengths": (np.dtype(np.int64), 1),
    "terminated": (np.dtype(np.bool_), 1),
}
"""The dtype and the number of axes of the arrays that every run has."""


def encode(header: Mapping[str, Any]) -> str:
    """Returns a header as JSON, with the name and the version of the format.

    Raises:
        TypeError: if it holds what JSON cannot.
        ValueError: if it holds a number that JSON cannot.
    """
    return json.dumps({"format": FORMAT, "version": FORMAT_VERSION, **header}, allow_nan=False)


def write(path: Path, header: str, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Writes a file, whole or not at all.

    Raises:
        OSError: if the file cannot be written.
    """
    members: dict[str, Any] = {"header": np.array(header), **arrays}
    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **members)


@contextmanager
def reading(file: BinaryIO) -> Iterator[tuple[dict[str, Any], Mapping[str, NDArray[Any]]]]:
    """Yields the header of a file, and its arrays, each of which is read when it is looked up.

    Raises:
        ValueError: if it is not a run file, or comes from another version of the format. A damaged file can raise
            almost anything else.
    """
    with zipfile.ZipFile(file) as archive:
        # An uncompressed array is no larger than its file, so a small file cannot ask for much memory.
        if any(entry.compress_type != zipfile.ZIP_STORED for entry in archive.infolist()):
            raise ValueError("it is compressed, which qtab's files are not")
    file.seek(0)
    with np.load(file, allow_pickle=False) as arrays:
        header = json.loads(str(arrays["header"]))
        if not isinstance(header, dict) or header.get("format") != FORMAT:
            raise ValueError("its header is not one of qtab's")
        if header["version"] != FORMAT_VERSION:
            raise ValueError(f"its format has version {header['version']!r}, this one reads {FORMAT_VERSION}")
        yield header, arrays


def array(arrays: Mapping[str, NDArray[Any]], name: str) -> NDArray[Any]:
    """Returns one of ``ARRAYS``.

    Raises:
        KeyError: if it is missing.
        ValueError: if it has another dtype or number of axes.
    """
    dtype, ndim = ARRAYS[name]
    found = arrays[name]
    if found.dtype != dtype or found.ndim != ndim:
        raise ValueError(f"its {name} has dtype {found.dtype} and {found.ndim} axes, not {dtype} and {ndim}")
    return found
