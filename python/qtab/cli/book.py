"""``qtab book``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from qtab import book
from qtab._utils.files import check_writable
from qtab._utils.progress import print_above
from qtab.cli.parsing import parse
from qtab.cli.usage import UsageError, refusing
from qtab.plots.axes import check_format

COMMAND = "qtab book"


@dataclass(frozen=True)
class Arguments:
    """Run an experiment of Sutton & Barto's book at the book's run counts, and print what it brings."""

    experiment: Annotated[tyro.conf.Positional[str | None], tyro.conf.arg(metavar="NAME")] = None
    """figure-10.4, or 10.4 where there is no example of that number; without a name they are listed."""
    runs: int | None = None
    """How many runs of each setting; as many as in the book where it is not given."""
    seed: int = 0
    """The seed of the first run; the others follow it."""
    plot: Path | None = None
    """Draw the figure to this file; its ending gives the format."""
    save: Path | None = None
    """Write every point to this CSV file."""
    threads: int | None = None
    """How many threads; one a core where it is not given. The numbers do not depend on it."""


def run(arguments: list[str]) -> int:
    """Runs what the arguments ask for; returns the exit code."""
    asked = parse(Arguments, COMMAND, arguments)
    if asked.experiment is None and (asked.plot is not None or asked.save is not None):
        raise UsageError("NAME must be given, of an experiment that qtab book lists")
    if asked.experiment is None:
        for name, experiment in book.EXPERIMENTS.items():
            print_above(f"{name:14}{experiment.title}")
        return 0
    with refusing():
        experiment = book.find(asked.experiment)
        if asked.plot is not None:
            check_format("plot", asked.plot)
            check_writable("plot", asked.plot)
        if asked.save is not None:
            check_writable("save", asked.save)
        experiment.check_arguments(asked.runs, asked.seed, asked.threads)
    result = experiment.run(asked.runs, asked.seed, threads=asked.threads)
    print_above(str(result))
    if asked.save is not None:
        result.save(asked.save)
        print_above(f"Saved the points to {asked.save}")
    if asked.plot is not None:
        from qtab.book.drawing import save_plot

        save_plot(result, asked.plot)
        print_above(f"Saved the plot to {asked.plot}")
    return 0
