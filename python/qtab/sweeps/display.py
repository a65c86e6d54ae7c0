"""How a notebook shows a sweep."""

from typing import TYPE_CHECKING

from qtab._utils import html, svg
from qtab.sweeps.run_versions import versions_note

if TYPE_CHECKING:
    from qtab.sweeps.results import Sweep

SHOWN_SETTINGS = 6
"""The number of settings that are shown."""


def sweep_html(sweep: "Sweep") -> str:
    """Returns a table and the mean learning curves of the settings with the best mean final return."""
    returns = {setting: sweep.values("final_return", setting) for setting in range(len(sweep.settings))}
    means = {setting: float(values.mean()) for setting, values in returns.items() if len(values)}
    best = sorted(means, key=means.__getitem__, reverse=True)[:SHOWN_SETTINGS]
    names = list(sweep.settings[0]) if sweep.settings else []
    columns = ("setting", *names, "runs", "mean final return")
    rows = [
        (
            setting,
            *(sweep.settings[setting][name] for name in names),
            len(returns[setting]),
            f"{means[setting]:.2f}",
        )
        for setting in best
    ]
    heading = f"Sweep of {sweep.env}: {len(sweep.settings)} settings, {len(sweep):,} runs, {sweep.failed} failed"
    if len(best) < len(sweep.settings):
        heading += f"; the best {len(best)}"
    note = versions_note(sweep.run_versions)
    curves = {f"setting {setting}": sweep.curves(setting).mean(axis=0) for setting in best}
    label = f"Mean learning curves in blocks of {sweep.block:,} episodes"
    colors = [svg.color(index) for index in range(len(best))]
    return html.listing(heading, columns, rows, svg.lines(label, curves), colors, [note] if note else [])
