"""``qtab report``: a sweep as CSV tables, plots and one HTML page."""

import csv
import io
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from qtab._utils.files import replacing
from qtab._utils.page import page, paragraph, picture, section, table
from qtab._utils.shown import counted
from qtab.envs.metadata.goals import what_changes_returns
from qtab.plots.parts.axes import not_shown, png
from qtab.sweeps.environments import environments_of, sweep_threshold
from qtab.sweeps.results import Sweep
from qtab.sweeps.run_versions import by_name, in_words, versions_note

if TYPE_CHECKING:
    from qtab.planning import Optimum

MAX_SETTINGS = 8
"""The number of settings, best first, that the pictures show: as many as there are different colors."""
DOTS_PER_INCH = 120


@dataclass(frozen=True)
class Picture:
    """A picture with its text alternative."""

    png: bytes
    alternative: str


def write_report(sweep: Sweep, folder: Path, command: str | None = None) -> list[Path]:
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
    written += [_write(folder / f"{name}.png", drawn.png) for name, drawn in pictures.items()]
    return [*written, _write(folder / "report.html", report_page(sweep, header, rows, pictures, command).encode())]


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


def report_page(
    sweep: Sweep,
    header: Sequence[str],
    rows: Sequence[Sequence[Any]],
    pictures: Mapping[str, Picture],
    command: str | None,
) -> str:
    """Returns the page, which needs no other file.

    Args:
        sweep: The sweep.
        header: The header of the table of settings.
        rows: Its rows, best first.
        pictures: The pictures by name.
        command: The command that writes the report, or None.
    """
    parts = [*map(paragraph, _notes(sweep, len(rows))), table(header, rows)]
    parts += [
        section(name.replace("_", " ", 1).capitalize(), picture(drawn.png, drawn.alternative))
        for name, drawn in pictures.items()
    ]
    parts.append(section("Settings that all runs share", table(("setting", "value"), _shared(sweep))))
    parts.append(section("How it was made", table((), _origin(sweep, command))))
    return page(sweep.env, "\n".join(parts))


def _notes(sweep: Sweep, ranked: int) -> list[str]:
    total = len(sweep.settings) * len(sweep.seeds)
    runs = ("" if len(sweep) == total else f"{len(sweep):,} of ") + counted(total, "run")
    settings, seeds = counted(len(sweep.settings), "setting"), counted(len(sweep.seeds), "seed")
    notes = [
        f"{runs}: {settings}, {seeds} each, {sweep.failed} failed. Final returns "
        "are means of the last 100 episodes; the interval of the mean has a coverage of 95%."
    ]
    if sweep.failed:
        notes.append(
            "The order is that of ranked_mean, in which a failed run counts as the worst run of the sweep. The other "
            "statistics leave failed runs out."
        )
    if ranked > 1:
        notes.append(
            f"The best of {ranked} settings looks better than it is, because the choice prefers lucky seeds. Train it "
            "again with other seeds: sweep.confirm(seeds=100) in Python, or qtab sweep with --confirm 100."
        )
    if ranked > MAX_SETTINGS:
        notes.append(f"The pictures show the best {MAX_SETTINGS} of {ranked} settings; the table has all of them.")
    if note := versions_note(sweep.run_versions):
        notes.append(note)
    return notes


def _shared(sweep: Sweep) -> list[tuple[str, Any]]:
    """Returns the settings that are given and the same for all runs."""
    first = sweep.configs[0]
    return [
        (name, value)
        for name, value in sorted(first.items())
        if value not in (None, [], {}) and all(config.get(name) == value for config in sweep.configs)
    ]


def _origin(sweep: Sweep, command: str | None) -> list[tuple[str, Any]]:
    rows: list[tuple[str, Any]] = [] if command is None else [("command", command)]
    rows += [("seeds", _seeds(sweep.seeds)), ("block", f"{sweep.block} episodes")]
    rows.append(("training", f"{sweep.seconds:.1f} s, summed over the processes that took part"))
    known = len(sweep) - list(sweep.run_versions).count(None)
    for name, values in by_name(sweep.run_versions).items():
        is_of_all = len(values) == 1 and known == len(sweep)
        rows.append((name, values[0][0] if is_of_all else in_words(values)))
    return rows if known else [*rows, ("versions", "unknown")]


def _seeds(seeds: Sequence[int]) -> str:
    if list(seeds) == list(range(seeds[0], seeds[0] + len(seeds))) and len(seeds) > 2:
        return f"{seeds[0]} to {seeds[-1]}"
    return ", ".join(map(str, seeds[:20])) + (", ..." if len(seeds) > 20 else "")


def draw(sweep: Sweep) -> dict[str, Picture]:
    """Returns the pictures by name: final returns, learning curves, and the sensitivity to each parameter."""
    from qtab import plots

    ranking = [setting for setting in sweep.ranking() if len(sweep.values("final_return", setting))]
    best = ranking[:MAX_SETTINGS]
    shown = (
        f"the best {len(best)} of {len(sweep.settings)} settings"
        if len(best) < len(sweep.settings)
        else (f"all {len(best)} settings" if len(best) > 1 else "the setting")
    )
    threshold, optimum = sweep_threshold(sweep), _optimum(sweep)
    marked = False if threshold is None else threshold
    means = ", ".join(
        f"{_label(sweep, setting)}: mean {sweep.values('final_return', setting).mean():.4g}" for setting in best
    )
    axes: dict[str, tuple[Any, str]] = {
        "distribution": (
            plots.distribution(sweep, settings=best),
            f"Distribution of the final returns of {shown}. {means}.",
        ),
        "profile": (
            plots.profile(sweep, settings=best),
            f"Performance profile of {shown}: the proportion of runs whose final return exceeds each value.",
        ),
    }
    if any(sweep.curves(setting).size for setting in best):
        text = f"Learning curves of {shown}: the mean return of each {sweep.block} episodes."
        if threshold is not None:
            text += f" A line marks the reward threshold, {threshold:g}."
        if optimum is not None:
            text += f" A line marks the {optimum.label}, {optimum.expected_return:g}."
        curves = plots.learning_curves(sweep, block=sweep.block, settings=best, optimum=optimum, threshold=marked)
        axes["learning_curves"] = (curves, text)
    for parameter in sweep.settings[0]:
        values = sorted(set(sweep.columns[parameter].tolist()), key=str)
        if len(values) > 1:
            text = f"The final return over {parameter}, which takes the values {', '.join(map(str, values[:20]))}."
            axes[f"sensitivity_{parameter}"] = (plots.sensitivity(sweep, parameter), text)
    return {title: Picture(png(ax.figure, DOTS_PER_INCH), text) for title, (ax, text) in axes.items()}


def _label(sweep: Sweep, setting: int) -> str:
    rounded = {
        name: f"{value:.4g}" if isinstance(value, float) else value for name, value in sweep.settings[setting].items()
    }
    return ", ".join(f"{name} {value}" for name, value in rounded.items())


def _spec(sweep: Sweep) -> Any:
    """Returns the spec of the environment if it is registered. A store must not choose a module to import."""
    return gym.registry.get(sweep.env.rpartition(":")[2])


def _optimum(sweep: Sweep) -> "Optimum | None":
    """Returns the optimum of the environment; None if it is not known, was changed, or differs between settings."""
    from qtab.planning import optimum

    spec, found = _spec(sweep), environments_of(sweep)
    if spec is None or len(found) > 1:
        return None
    _, kwargs, max_episode_steps, description = found[0]
    if description is not None and what_changes_returns(description, spec, kwargs) is not None:
        return None
    with suppress(ValueError, TypeError, gym.error.Error):
        return optimum(spec, env_kwargs=kwargs, max_episode_steps=max_episode_steps)
    return None
