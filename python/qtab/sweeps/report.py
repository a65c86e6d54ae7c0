"""``qtab report``: a sweep as CSV tables, plots and one HTML page."""

import base64
import csv
import html
import io
from pathlib import Path
from typing import Any

import numpy as np

from qtab._utils.files import replacing
from qtab.plots.axes import not_shown
from qtab.sweeps.results import Sweep

BEST_SETTINGS = 5
"""The number of settings with the best mean final return that the plots show."""
_STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:64rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "table{border-collapse:collapse}td,th{padding:.25rem .7rem;text-align:right;border-bottom:1px solid #ddd}"
    "img{max-width:100%}"
)


def report(sweep: Sweep, folder: Path) -> list[Path]:
    """Writes ``runs.csv``, ``settings.csv``, the plots as PNG, and ``report.html``, which contains all but the runs.

    Args:
        sweep: What to report.
        folder: Where to write; created if it does not exist.

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
    header, rows = _settings_table(sweep)
    with not_shown():
        plots = _plots(sweep, [row[0] for row in rows])
    written = [
        _write(folder / "runs.csv", _csv(list(sweep.columns), zip(*sweep.columns.values(), strict=True)).encode()),
        _write(folder / "settings.csv", _csv(header, rows).encode()),
    ]
    written += [_write(folder / f"{name}.png", png) for name, png in plots.items()]
    return [*written, _write(folder / "report.html", _page(sweep, header, rows, plots).encode())]


def _settings_table(sweep: Sweep) -> tuple[list[str], list[list[Any]]]:
    """Returns the header and one row per setting, sorted by the mean final return, best first."""
    from qtab import stats
    from qtab.stats.intervals import interquartile_mean

    names = list(sweep.settings[0])
    header = ["setting", *names, "runs", "failed", "mean", "low", "high", "median", "iqm"]
    rows = []
    for setting in range(len(sweep.settings)):
        values = sweep.values("final_return", setting)
        runs = np.flatnonzero(sweep.columns["setting"] == setting)
        if len(values):
            interval = stats.mean(values) if len(values) > 1 else None  # a single run has none
            bounds = ["", ""] if interval is None else [interval.low, interval.high]
            cells = [sweep.columns[name][runs[0]] for name in names]
            estimates = [float(np.median(values)), float(interquartile_mean(values))]
            failed = len(runs) - len(values)
            rows.append([setting, *cells, len(values), failed, float(np.mean(values)), *bounds, *estimates])
    mean_column = header.index("mean")
    return header, sorted(rows, key=lambda row: -row[mean_column])


def _plots(sweep: Sweep, ranking: list[int]) -> dict[str, bytes]:
    """Returns the plots as PNG, by name; ``ranking`` lists the settings, best first."""
    from qtab import plots

    def label(setting: int) -> str:
        return ", ".join(f"{name} {value}" for name, value in _rounded(sweep, setting).items())

    best = ranking[:BEST_SETTINGS]
    final_returns = {label(setting): sweep.values("final_return", setting) for setting in best}
    axes = {"distribution": plots.distribution(final_returns), "profile": plots.profile(final_returns)}
    curves = None
    for index, setting in enumerate(best):
        if sweep.curves(setting).size:
            # The store has only the mean of each block; learning_curves averages the same blocks again.
            returns = np.repeat(sweep.curves(setting), sweep.block, axis=1)
            curves = plots.learning_curves(returns, curves, block=sweep.block, label=label(setting), index=index)
    if curves is not None:
        axes["learning_curves"] = curves
    for parameter in sweep.settings[0]:
        if len(set(sweep.columns[parameter].tolist())) > 1:
            axes[f"sensitivity_{parameter}"] = plots.sensitivity(sweep, parameter)
    return {title: _png(ax) for title, ax in axes.items()}


def _rounded(sweep: Sweep, setting: int) -> dict[str, Any]:
    return {
        name: f"{value:.4g}" if isinstance(value, float) else value for name, value in sweep.settings[setting].items()
    }


def _png(ax: Any) -> bytes:
    buffer = io.BytesIO()
    ax.figure.savefig(buffer, format="png", dpi=120)
    return buffer.getvalue()


def _csv(header: list[str], rows: Any) -> str:
    buffer = io.StringIO()
    writer = csv.writer(buffer)
    writer.writerow(header)
    writer.writerows(rows)
    return buffer.getvalue()


def _page(sweep: Sweep, header: list[str], rows: list[list[Any]], plots: dict[str, bytes]) -> str:
    def cell(value: Any) -> str:
        return html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))

    head = "".join(f"<th>{html.escape(name)}</th>" for name in header)
    body = "\n".join("<tr>" + "".join(f"<td>{cell(value)}</td>" for value in row) + "</tr>" for row in rows)
    images = "\n".join(
        f"<h2>{html.escape(name.replace('_', ' ', 1).capitalize())}</h2>\n"
        f'<img alt="{html.escape(name)}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'
        for name, png in plots.items()
    )
    env = html.escape(sweep.env)
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{env}</title><style>{_STYLE}</style>\n'
        f"<h1>{env}</h1>\n<p>{len(sweep)} runs: {len(sweep.settings)} settings, {len(sweep.seeds)} seeds each, "
        f"{sweep.failed} failed. Final returns are means of the last 100 episodes; the 95% interval of the mean "
        f"is Student's t interval for fewer than 30 runs, else the bootstrap's.</p>\n"
        f"<table><tr>{head}</tr>\n{body}</table>\n{images}\n</html>\n"
    )


def _write(path: Path, content: bytes) -> Path:
    with replacing(path) as temporary:
        temporary.write_bytes(content)
    return path
