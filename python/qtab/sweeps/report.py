"""A sweep's store as tables, pictures and one HTML page."""

import base64
import csv
import html
import io
from pathlib import Path
from typing import Any

import numpy as np

from qtab._utils.files import replacing
from qtab.sweeps.results import Sweep

SHOWN_SETTINGS = 5
"""So many of the best settings have their learning curves drawn."""
_STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:64rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "table{border-collapse:collapse}td,th{padding:.25rem .7rem;text-align:right;border-bottom:1px solid #ddd}"
    "img{max-width:100%}"
)


def report(sweep: Sweep, folder: Path) -> list[Path]:
    """Writes ``runs.csv``, ``settings.csv``, the pictures, and ``report.html``, which holds all but the runs.

    Raises:
        ModuleNotFoundError: without matplotlib or scipy; it names the ``pip install``.
        OSError: if the folder cannot be written to.
        ValueError: if no run has finished.
    """
    if len(sweep) == sweep.failed:
        raise ValueError("the store must hold at least one run that finished, got none")
    folder.mkdir(parents=True, exist_ok=True)
    header, rows = _settings(sweep)
    pictures = _pictures(sweep, [row[0] for row in rows])
    written = [
        _write(folder / "runs.csv", _csv(list(sweep.columns), zip(*sweep.columns.values(), strict=True)).encode()),
        _write(folder / "settings.csv", _csv(header, rows).encode()),
    ]
    written += [_write(folder / f"{name}.png", picture) for name, picture in pictures.items()]
    return [*written, _write(folder / "report.html", _page(sweep, header, rows, pictures).encode())]


def _settings(sweep: Sweep) -> tuple[list[str], list[list[Any]]]:
    """A row a setting, the best first."""
    from qtab import stats

    names = list(sweep.settings[0])
    header = ["setting", *names, "runs", "failed", "mean", "low", "high", "median", "iqm"]
    rows = []
    for setting in range(len(sweep.settings)):
        values = sweep.values("final_return", setting)
        here = np.flatnonzero(sweep.columns["setting"] == setting)
        if len(values):
            mean = stats.mean(values)
            cells = [sweep.columns[name][here[0]] for name in names]
            others = [stats.median(values).estimate, stats.iqm(values).estimate]
            failed = len(here) - len(values)
            rows.append([setting, *cells, len(values), failed, mean.estimate, mean.low, mean.high, *others])
    return header, sorted(rows, key=lambda row: -row[-5])


def _pictures(sweep: Sweep, order: list[int]) -> dict[str, bytes]:
    from qtab import plots

    def name(setting: int) -> str:
        return ", ".join(f"{key} {value}" for key, value in _rounded(sweep, setting).items())

    best = order[:SHOWN_SETTINGS]
    finals = {name(setting): sweep.values("final_return", setting) for setting in best}
    axes = {"distribution": plots.distribution(finals), "profile": plots.profile(finals)}
    curves = None
    for index, setting in enumerate(best):
        if sweep.curves(setting).size:
            # Means of blocks, each standing for its episodes.
            returns = np.repeat(sweep.curves(setting), sweep.block, axis=1)
            curves = plots.learning_curves(returns, curves, block=sweep.block, label=name(setting), index=index)
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


def _page(sweep: Sweep, header: list[str], rows: list[list[Any]], pictures: dict[str, bytes]) -> str:
    def cell(value: Any) -> str:
        return html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))

    head = "".join(f"<th>{html.escape(name)}</th>" for name in header)
    body = "\n".join("<tr>" + "".join(f"<td>{cell(value)}</td>" for value in row) + "</tr>" for row in rows)
    images = "\n".join(
        f"<h2>{html.escape(name.replace('_', ' ', 1).capitalize())}</h2>\n"
        f'<img alt="{html.escape(name)}" src="data:image/png;base64,{base64.b64encode(picture).decode()}">'
        for name, picture in pictures.items()
    )
    env = html.escape(sweep.env)
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{env}</title><style>{_STYLE}</style>\n'
        f"<h1>{env}</h1>\n<p>{len(sweep)} runs: {len(sweep.settings)} settings, {len(sweep.seeds)} seeds each, "
        f"{sweep.failed} failed. Final returns are means of the last 100 episodes; the interval of the mean is the "
        f"95% bootstrap (BCa) one.</p>\n<table><tr>{head}</tr>\n{body}</table>\n{images}\n</html>\n"
    )


def _write(path: Path, content: bytes) -> Path:
    with replacing(path) as temporary:
        temporary.write_bytes(content)
    return path
