"""``qtab.Sweep``: the results of a sweep as a table with one row per run."""

import os
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks, html
from qtab._utils.data_frames import arrow_table, cell_column, data_frame, integer_column
from qtab._utils.shown import counted, did_you_mean
from qtab.sweeps.again import plan_again, trained_again
from qtab.sweeps.confirm import Confirmation, chosen_settings, other_seeds
from qtab.sweeps.run_records import SUMMARY_COLUMNS
from qtab.sweeps.run_versions import Versions, different_versions, versions_note, versions_of_runs
from qtab.sweeps.store_format import Contents
from qtab.sweeps.study import Study, to_cell
from qtab.sweeps.training import SweepCallback, run_study

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

    from qtab.envs.origin.description import EnvironmentDescription
    from qtab.results.run import Run

INTEGER_COLUMNS = ("episodes", "steps")
"""The summary columns that hold integers, which a store keeps as floats."""
SHOWN_SETTINGS = 6
"""The number of settings that a notebook shows."""


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """The finished runs of all settings. Interruptions do not change the table."""

    env: str
    """The environment's id."""
    settings: Sequence[Mapping[str, Any]]
    """The values of the grid for each setting."""
    seeds: tuple[int, ...]
    """The seeds of every setting."""
    columns: Mapping[str, NDArray[Any]]
    """(runs,) each: ``setting`` (an index), the names in the grid, ``seed``, the summary of the run, and ``error``.

    Seeds are int64, uint64 if one needs it, or Python integers in an object array if one is at least 2**64. Values of a
    setting that have different types are in an object array."""
    block: int
    """The number of episodes that each point of a learning curve averages."""
    _curves: Sequence[bytes]
    configs: Sequence[Mapping[str, Any]] = ()
    """The complete config of each setting without the seed, as JSON represents it."""
    seconds: float = 0.0
    """The training time in seconds, summed over all processes."""
    versions: str = "{}"
    """The software versions of the process that started the sweep, as JSON text; see also :attr:`run_versions`."""
    _source: Any = field(default=None)
    """The environment and the overrides of each setting, if the sweep was trained in this process."""
    run_versions: Sequence[Versions] = ()
    """(runs,): the software versions that trained each run; None in stores of earlier versions."""
    _environments: Mapping[int, "EnvironmentDescription"] = field(default_factory=dict)
    """The environments of the settings, as far as they are known; stores of earlier versions do not hold them."""

    def __repr__(self) -> str:
        versions = ", different versions" if different_versions(self.run_versions) else ""
        return f"<{self._summary}{versions}>"

    @property
    def _summary(self) -> str:
        settings, runs = counted(len(self.settings), "setting"), counted(len(self), "run")
        return f"Sweep of {self.env}: {settings}, {runs}, {self.failed} failed"

    def _repr_html_(self) -> str:
        """Returns a table and the mean learning curves of the best settings, for notebooks."""
        returns = {setting: self.values("final_return", setting) for setting in range(len(self.settings))}
        means = {setting: float(values.mean()) for setting, values in returns.items() if len(values)}
        best = sorted(means, key=means.__getitem__, reverse=True)[:SHOWN_SETTINGS]
        names = list(self.settings[0]) if self.settings else []
        rows = [
            (setting, *map(self.settings[setting].get, names), len(returns[setting]), f"{means[setting]:.2f}")
            for setting in best
        ]
        heading = self._summary + (f"; the best {len(best)}" if len(best) < len(self.settings) else "")
        note = versions_note(self.run_versions)
        curves = {f"setting {setting}": self.curves(setting).mean(axis=0) for setting in best}
        lines = html.lines(f"Mean learning curves in blocks of {counted(self.block, 'episode')}", curves)
        columns, colors = ("setting", *names, "runs", "mean final return"), [html.color(i) for i in range(len(best))]
        return html.listing(heading, columns, rows, lines, colors, [note] if note else [])

    def __len__(self) -> int:
        return len(self.columns["seed"])

    @property
    def failed(self) -> int:
        """The number of failed runs; the column ``error`` has the reasons."""
        return int(self._has_failed.sum())

    def values(self, column: str, setting: int) -> NDArray[Any]:
        """Returns a column for the successful runs of one setting, in the order of the seeds.

        Raises:
            KeyError: for an unknown column.
            TypeError: if ``setting`` is not an integer.
            ValueError: if there is no such setting.
        """
        rows = self._succeeded(setting)
        if column not in self.columns:
            near = did_you_mean(column, self.columns) if isinstance(column, str) else ""
            raise KeyError(f"column must be one of {', '.join(self.columns)}, got {column!r}{near}")
        values: NDArray[Any] = self.columns[column][rows]
        return values

    def curves(self, setting: int) -> NDArray[np.float64]:
        """Returns (runs, blocks): the learning curves of the successful runs of one setting.

        Raises:
            TypeError: if ``setting`` is not an integer.
            ValueError: if there is no such setting.
        """
        curves = [np.frombuffer(self._curves[row]) for row in self._succeeded(setting).tolist()]
        return np.array(curves) if curves else np.empty((0, 0))

    def rows(self, setting: int) -> NDArray[np.intp]:
        """Returns the rows of all runs of one setting, including failed ones, in the order of the seeds.

        Raises:
            TypeError: if ``setting`` is not an integer.
            ValueError: if there is no such setting.
        """
        return self._by_setting[checks.integer("setting", setting, least=0, most=len(self.settings) - 1)]

    def _succeeded(self, setting: int) -> NDArray[np.intp]:
        rows = self.rows(setting)
        return rows[~self._has_failed[rows]]

    @cached_property
    def _has_failed(self) -> NDArray[np.bool_]:
        return np.array([error is not None for error in self.columns["error"]], dtype=np.bool_)

    @cached_property
    def _by_setting(self) -> list[NDArray[np.intp]]:
        """The rows of each setting."""
        setting = self.columns["setting"]
        order = np.argsort(setting, kind="stable")
        return np.split(order, np.searchsorted(setting[order], np.arange(1, len(self.settings))))

    def mean_final_returns(self) -> NDArray[np.float64]:
        """Returns (settings,): the mean final return of each setting, in which a failed run counts as the worst run.

        A failed run has no return. Leaving it out would favour a setting that sometimes diverges, so it counts as the
        lowest final return of the whole sweep. Settings without finished runs have NaN; settings whose runs all failed
        have -inf.
        """
        returns = self.columns["final_return"]
        has_failed = np.isnan(returns)
        worst = np.min(returns[~has_failed], initial=np.inf)
        means = np.full(len(self.settings), np.nan)
        for index in range(len(self.settings)):
            mine = self.rows(index)
            if len(mine):
                is_lost = has_failed[mine].all()
                means[index] = -np.inf if is_lost else np.where(has_failed[mine], worst, returns[mine]).mean()
        return means

    def ranking(self) -> list[int]:
        """Returns the indices of the settings, best first, by :meth:`mean_final_returns`.

        The first place is partly luck: the best of many settings looks better than it is. :meth:`confirm` trains it
        again with other seeds. Settings without finished runs are left out.
        """
        means = self.mean_final_returns()
        return [int(index) for index in np.argsort(-means, kind="stable") if not np.isnan(means[index])]

    def confirm(
        self,
        seeds: int | Iterable[int] = 100,
        *,
        top: int = 1,
        per: str | None = None,
        settings: Sequence[int] | None = None,
        env: Any = None,
        store: "str | os.PathLike[str] | None" = None,
        executor: Executor | None = None,
        threads: int | None = None,
        memory_limit: int | None = None,
        callback: SweepCallback | None = None,
        progress: bool | None = None,
    ) -> Confirmation:
        """Trains the best settings, or given ones, again with seeds that the sweep did not use, for unbiased means.

        The mean by which a setting was chosen is too high on average, because the choice favours lucky seeds.

        Args:
            seeds: Seeds that the sweep did not use; an integer N means the N seeds after its largest one.
            top: The number of settings to train again, the first ones of :meth:`ranking`.
            per: The name of a setting in the grid, such as ``"algorithm"``: trains the ``top`` best settings for each
                of its values. None takes the best of all settings.
            settings: The indices of the settings to train again, whatever their rank.
            env: The environment, as for :func:`qtab.sweep`, which must be that of the sweep. None takes the sweep's. If
                the sweep was loaded from a store, the id must already be registered, and wrappers and changed
                attributes are made again if the store describes them well enough.
            store: As for :func:`qtab.sweep`; it must not be the file of this sweep.
            executor: As for :func:`qtab.sweep`.
            threads: As for :func:`qtab.sweep`.
            memory_limit: As for :func:`qtab.sweep`.
            callback: As for :func:`qtab.sweep`.
            progress: As for :func:`qtab.sweep`.

        Raises:
            RuntimeError: if the executor fails.
            StoreError: if the store is damaged, or belongs to another sweep.
            TypeError: for an argument of the wrong type.
            ValueError: for seeds that the sweep used, an argument out of range, settings that cannot be restored, or an
                environment that cannot be made again or differs; the message gives the reason.
            KeyboardInterrupt: on Ctrl-C; its attribute ``run`` is the table of the finished runs.
        """
        chosen = chosen_settings(self, top, per, settings)
        study = plan_again(self, chosen, other_seeds(self, seeds), env)
        again = run_study(
            study, partial(build_sweep, study=study), store, executor, threads, memory_limit, callback, progress
        )
        return Confirmation(tuple(chosen), self, again)

    def run(self, setting: int, seed: int, *, env: Any = None) -> "Run":
        """Trains a run of the table again, to get its Q tables and episodes, for example to verify or plot it.

        Args:
            setting: The index of the setting.
            seed: The seed of the run.
            env: The environment, as for :meth:`confirm`.

        Raises:
            TypeError: for an argument of the wrong type.
            ValueError: for an argument out of range, a failed run, an environment that cannot be made again or differs,
                or results that differ from those of the table.
        """
        return trained_again(self, setting, seed, env)

    def to_pandas(self) -> "pd.DataFrame":
        """Returns the table as a pandas data frame.

        Columns of integers are int64, or pandas' Int64 with missing values if runs failed. Seeds have the same dtype as
        in :attr:`columns`.

        Raises:
            ModuleNotFoundError: without pandas; the message names the ``pip install``.
        """
        return data_frame(self.columns, INTEGER_COLUMNS)

    def to_arrow(self) -> "pa.Table":
        """Returns the table as an Arrow table, for polars (``polars.from_arrow``) or Parquet files.

        Seeds from 2**64 on, and settings with values of different types, become text.

        Raises:
            ModuleNotFoundError: without pyarrow.
        """
        return arrow_table(self.columns, INTEGER_COLUMNS, ("error",))


def build_sweep(
    contents: Contents, study: Study | None = None, environments: Mapping[int, "EnvironmentDescription"] | None = None
) -> Sweep:
    """Returns the table of the stored runs of a study.

    Args:
        contents: The contents of the store.
        study: The study, if it was planned in this process.
        environments: Without a study, the environments of the settings, as far as the store describes them.
    """
    stored, runs = contents.study, contents.runs
    settings = stored.settings if study is None else study.settings
    indices = np.array([run[0] for run in runs], dtype=np.int64)
    setting, position = np.divmod(indices, len(stored.seeds))
    columns: dict[str, Any] = {"setting": setting}
    for name in settings[0]:
        columns[name] = cell_column([to_cell(values[name]) for values in settings])[setting]
    columns["seed"] = integer_column(stored.seeds)[position]
    for place, name in enumerate(SUMMARY_COLUMNS, start=2):
        values = [np.nan if run[place] is None else run[place] for run in runs]
        columns[name] = np.array(values, dtype=np.float64)
    columns["error"] = np.array([run[-1] for run in runs], dtype=object)
    return Sweep(
        env=stored.configs[0]["env"],
        settings=settings,
        seeds=stored.seeds,
        columns=columns,
        block=stored.block,
        _curves=[run[-2] for run in runs],
        configs=stored.configs,
        seconds=contents.seconds,
        versions=contents.meta.get("versions", "{}"),
        _source=study and (study.env, study.overrides),
        run_versions=versions_of_runs(contents.meta, contents.places),
        _environments=study.environments if study else environments or {},
    )
