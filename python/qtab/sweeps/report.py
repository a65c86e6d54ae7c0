"""``qtab report``: a sweep as CSV tables, plots and one HTML page."""

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np

from qtab._utils.files import replacing
from qtab.plots.axes import not_shown
from qtab.sweeps.report_page import page
from qtab.sweeps.report_plots import draw
from qtab.sweeps.results import Sweep


def report(sweep: Sweep, folder: Path, command: str | None = None) -> list[Path]:
    """Writes ``runs.csv``, ``settings.csv``, the plots as PNG, and ``report.html``, which contains all but the runs.

    Args:
        sweep: What to report.
        folder: Where to write; created if it does not exist.
        command: The command that writes the report, which the page shows.

    Returns:
        The files written, ``report.html`` last.

    Raises:
        ModuleNotFoundError: without matplotlib or scipy; the message names the ``pip install``.
        OSError: if the folder cannot be written to.
        ValueError: if there is no run that succeeded.
    """
    if len(sweep) == sweep.failed:
        raise ValueError("the store must have at least one run that succeeded, got none")
    folder.mkdir(parents=True, exist_ok=True)
    header, rows = settings_table(sweep)
    with not_shown():
        pictures = draw(sweep)
    written = [
        _write(folder / "runs.csv", _csv(list(sweep.columns), zip(*sweep.columns.values(), strict=True)).encode()),
        _write(folder / "settings.csv", _csv(header, rows).encode()),
    ]
    written += [_write(folder / f"{name}.png", picture.png) for name, picture in pictures.items()]
    return [*written, _write(folder / "report.html", page(sweep, header, rows, pictures, command).encode())]


def settings_table(sweep: Sweep) -> tuple[list[str], list[list[Any]]]:
    """Returns the header and one row per setting with finished runs, in the order of the ranking.

    ``ranked_mean`` is the mean in which a failed run counts as the worst run; the other statistics leave failed runs
    out, and are empty if all failed. An interval needs two runs.
    """
    from qtab import stats
    from qtab.stats.intervals import interquartile_mean

    names = list(sweep.settings[0])
    header = ["setting", *names, "runs", "failed", "ranked_mean", "mean", "low", "high", "median", "iqm"]
    ranked = sweep.mean_final_returns()
    rows = []
    for setting in sweep.ranking():
        values = sweep.values("final_return", setting)
        runs = sweep.rows(setting)
        cells = [sweep.columns[name][runs[0]] for name in names]
        numbers: list[Any] = [None] * 5
        if len(values):
            interval = stats.mean(values) if len(values) > 1 else None
            bounds = [None, None] if interval is None else [interval.low, interval.high]
            numbers = [float(values.mean()), *bounds, float(np.median(values)), float(interquartile_mean(values))]
        rows.append([setting, *cells, len(values), len(runs) - len(values), ranked[setting], *numbers])
    return header, rows


def _csv(header: list[str], rows: Any) -> str:
    buffer = io.StringIO()
    writer = csv.writer(buffer)
    writer.writerow(header)
    writer.writerows(rows)
    return buffer.getvalue()


def _write(path: Path, content: bytes) -> Path:
    with replacing(path) as temporary:
        temporary.write_bytes(content)
    return path
