"""Reading a store without the call that made it."""

import json
import os
import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from qtab.sweeps.results import Sweep
from qtab.sweeps.store import COLUMNS, FORMAT, FORMAT_VERSION, StoreError
from qtab.sweeps.study import plain

_ROWS = f"SELECT run, {', '.join(COLUMNS)}, curve, error FROM runs ORDER BY run"  # noqa: S608 - fixed names


def load_sweep(path: "str | os.PathLike[str]") -> Sweep:
    """Returns the finished runs of a store, of a sweep underway too; ``env`` and all settings are its own.

    Raises:
        OSError: if there is no such file, or it cannot be read.
        StoreError: if it is no store, is damaged, or comes from another version.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"there is no store {str(path)!r}")
    try:
        with closing(sqlite3.connect(path)) as connection:
            meta = dict(connection.execute("SELECT name, value FROM meta").fetchall())
            if meta.get("format") != FORMAT:
                raise StoreError(f"{str(path)!r} is no store of a sweep")
            if meta.get("version") != str(FORMAT_VERSION):
                version = meta.get("version")
                raise StoreError(f"{str(path)!r} has version {version!r} of the format, this qtab has {FORMAT_VERSION}")
            study = json.loads(meta["study"])
            rows = connection.execute(_ROWS).fetchall()
    except (sqlite3.DatabaseError, KeyError, json.JSONDecodeError) as error:
        raise StoreError(f"{str(path)!r} is damaged or no store of a sweep: {error}") from error
    return table(study["configs"][0]["env"], study["settings"], tuple(study["seeds"]), study["block"], rows)


def table(
    env: str, settings: Sequence[Mapping[str, Any]], seeds: tuple[int, ...], block: int, rows: list[tuple[Any, ...]]
) -> Sweep:
    """Returns a sweep from what its store holds."""
    count = len(seeds)
    columns: dict[str, Any] = {"setting": np.array([row[0] // count for row in rows], dtype=np.int64)}
    for name in settings[0]:
        cells = [plain(setting[name]) for setting in settings]
        columns[name] = np.array([cells[row[0] // count] for row in rows])
    columns["seed"] = np.array([seeds[row[0] % count] for row in rows])
    for index, name in enumerate(COLUMNS, start=1):
        columns[name] = np.array([np.nan if row[index] is None else row[index] for row in rows], dtype=np.float64)
    columns["error"] = np.array([row[-1] for row in rows], dtype=object)
    return Sweep(env, settings, seeds, columns, block, [row[-2] for row in rows])
