"""A result as text for a person, and as CSV for everything else."""

import csv
import math
import textwrap
from collections.abc import Iterator
from pathlib import Path

from qtab._utils.files import replacing
from qtab.book.experiment import Line, Result

WIDTH = 100
COLUMNS = ("line", "x", "mean", "standard_error", "runs", "capped_episodes", "diverged_runs")


def table(result: Result) -> str:
    """Returns the settings, the counts, and a row for each point that the experiment shows."""
    experiment = result.experiment
    rows = [("", experiment.x, experiment.y, "std. error", "capped", "diverged")]
    for line in result.lines:
        for index in _shown(result, line):
            error = line.error[index]
            rows.append(
                (
                    line.name,
                    f"{line.x[index]:g}",
                    _rounded(line.mean[index], error),
                    "-" if math.isnan(error) else _rounded(error, error),
                    str(line.capped[index]),
                    str(line.diverged[index]),
                )
            )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]
    return "\n".join([*_head(result), "", *lines])


def save(result: Result, path: Path) -> None:
    """Writes every point of every line, whole or not at all."""
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for line in result.lines:
            columns = line.x, line.mean, line.error, line.capped, line.diverged
            for x, mean, error, capped, diverged in zip(*(column.tolist() for column in columns), strict=True):
                writer.writerow((line.name, x, mean, "" if math.isnan(error) else error, line.runs, capped, diverged))


def _head(result: Result) -> Iterator[str]:
    experiment = result.experiment
    yield f"{experiment.name.replace('-', ' ').capitalize()}: {experiment.title}"
    for name, text in (("the book", experiment.book), ("it leaves open", experiment.silent)):
        yield from textwrap.wrap(f"{name}: {text}", WIDTH, initial_indent="  ", subsequent_indent="    ")
    counts = " and ".join(f"{count:,}" for count in sorted({line.runs for line in result.lines}, reverse=True))
    runs = f"{counts} {'run' if counts == '1' else 'runs'} of each setting"
    if result.runs != experiment.runs:
        runs += (
            f" ({'FEWER' if result.runs < experiment.runs else 'more'} than the {experiment.runs:,} of a whole figure)"
        )
    rest = f"seeds from {result.seed}; episodes are capped at {experiment.cap:,} steps; {result.seconds:.1f} s"
    yield from textwrap.wrap(f"{runs}, {rest}", WIDTH, initial_indent="  ", subsequent_indent="    ")


def _shown(result: Result, line: Line) -> list[int]:
    shown = result.experiment.shown
    return [index for index, x in enumerate(line.x) if shown is None or x in shown]


def _rounded(mean: float, error: float) -> str:
    """As far as the first two digits of the standard error."""
    if math.isnan(error) or error <= 0:
        return f"{mean:.5g}"
    return f"{mean:,.{max(0, 1 - math.floor(math.log10(error)))}f}"
