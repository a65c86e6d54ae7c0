"""``qtab.Sweep``: the results of a sweep as a table with one row per run, and how they are read from a store."""

import json
import os
import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import html, svg
from qtab._utils.extras import missing
from qtab._utils.frames import data_frame
from qtab.sweeps.database import SUMMARY_COLUMNS, StoredRun, damaged, read_fingerprint, read_runs
from qtab.sweeps.study import to_cell

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa


INTEGER_COLUMNS = ("episodes", "steps")
"""The summary columns that hold integers, which a store keeps as floats."""
SHOWN_SETTINGS = 6
"""The number of settings that a notebook shows."""


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """The finished runs of all settings. The same sweep gives the same table, whether or not it was interrupted."""

    env: str
    """The environment's id."""
    settings: Sequence[Mapping[str, Any]]
    """The values that the grid gives to each setting."""
    seeds: tuple[int, ...]
    """The seeds of every setting."""
    columns: Mapping[str, NDArray[Any]]
    """(runs,) each: ``setting`` (its index), the names in the grid, ``seed``, the summary of the run, and ``error``."""
    block: int
    """The number of episodes that each point of a learning curve averages."""
    _curves: Sequence[bytes]

    def __repr__(self) -> str:
        settings = f"{len(self.settings)} setting{'' if len(self.settings) == 1 else 's'}"
        return f"<Sweep of {self.env}: {settings}, {len(self):,} runs, {self.failed} failed>"

    def _repr_html_(self) -> str:
        """A table and the mean learning curves of the settings with the best mean final return, for notebooks."""
        means = {
            setting: float(values.mean())
            for setting in range(len(self.settings))
            if len(values := self.values("final_return", setting))
        }
        best = sorted(means, key=means.__getitem__, reverse=True)[:SHOWN_SETTINGS]
        names = list(self.settings[0]) if self.settings else []
        columns = ("setting", *names, "runs", "mean final return")
        rows = [
            (
                setting,
                *(self.settings[setting][name] for name in names),
                len(self._rows(setting)),
                f"{means[setting]:.2f}",
            )
            for setting in best
        ]
        heading = f"Sweep of {self.env}: {len(self.settings)} settings, {len(self):,} runs, {self.failed} failed"
        if len(best) < len(self.settings):
            heading += f"; the best {len(best)}"
        curves = {f"setting {setting}": self.curves(setting).mean(axis=0) for setting in best}
        label = f"Mean learning curves in blocks of {self.block:,} episodes"
        colors = [svg.color(index) for index in range(len(best))]
        return html.listing(heading, columns, rows, svg.lines(label, curves), colors)

    def __len__(self) -> int:
        return len(self.columns["seed"])

    @property
    def failed(self) -> int:
        """The number of runs that failed; the column ``error`` has the reasons."""
        return sum(error is not None for error in self.columns["error"])

    def values(self, column: str, setting: int) -> NDArray[Any]:
        """Returns a column for the runs of one setting that did not fail, ordered as the seeds.

        Raises:
            KeyError: for an unknown column.
        """
        values: NDArray[Any] = self.columns[column][self._rows(setting)]
        return values

    def curves(self, setting: int) -> NDArray[np.float64]:
        """Returns (runs, blocks): the learning curves of the runs of one setting that did not fail."""
        curves = [np.frombuffer(self._curves[row]) for row in self._rows(setting).tolist()]
        return np.array(curves) if curves else np.empty((0, 0))

    def _rows(self, setting: int) -> NDArray[np.intp]:
        succeeded = np.array([error is None for error in self.columns["error"]], dtype=np.bool_)
        return np.flatnonzero((self.columns["setting"] == setting) & succeeded)

    def to_pandas(self) -> "pd.DataFrame":
        """Returns the table as a pandas data frame.

        Columns of integers are int64; where runs failed, pandas' Int64, which has missing values.

        Raises:
            ModuleNotFoundError: without pandas; the message names the ``pip install``.
        """
        return data_frame(self.columns, INTEGER_COLUMNS)

    def to_arrow(self) -> "pa.Table":
        """Returns the table as an Arrow table, which polars (``polars.from_arrow``) and Parquet files take.

        Raises:
            ModuleNotFoundError: without pyarrow.
        """
        try:
            import pyarrow as pa
        except ModuleNotFoundError as error:
            raise missing(error) from None
        types = {"error": pa.string(), **dict.fromkeys(INTEGER_COLUMNS, pa.int64())}
        return pa.table(
            {name: pa.array(column, types.get(name), from_pandas=True) for name, column in self.columns.items()}
        )


def load_sweep(path: "str | os.PathLike[str]") -> Sweep:
    """Returns the finished runs of a store, which may belong to a sweep that is still running.

    Raises:
        OSError: if the file does not exist.
        StoreError: if it is not a store, is damaged, or has another format version.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"store not found: {str(path)!r}")
    try:
        with closing(sqlite3.connect(path)) as connection:
            study = json.loads(read_fingerprint(connection, path))
            runs = read_runs(connection)
        env = study["configs"][0]["env"]
        return build_sweep(env, study["settings"], tuple(study["seeds"]), study["block"], runs)
    except (sqlite3.DatabaseError, KeyError, json.JSONDecodeError) as error:
        raise damaged(path, error) from error


def build_sweep(
    env: str, settings: Sequence[Mapping[str, Any]], seeds: tuple[int, ...], block: int, runs: Sequence[StoredRun]
) -> Sweep:
    """Returns the table of the stored runs of a study."""
    count = len(seeds)
    columns: dict[str, Any] = {"setting": np.array([run[0] // count for run in runs], dtype=np.int64)}
    for name in settings[0]:
        cells = [to_cell(setting[name]) for setting in settings]
        columns[name] = np.array([cells[run[0] // count] for run in runs])
    columns["seed"] = np.array([seeds[run[0] % count] for run in runs])
    for position, name in enumerate(SUMMARY_COLUMNS, start=1):
        values = [np.nan if run[position] is None else run[position] for run in runs]
        columns[name] = np.array(values, dtype=np.float64)
    columns["error"] = np.array([run[-1] for run in runs], dtype=object)
    return Sweep(env, settings, seeds, columns, block, [run[-2] for run in runs])
