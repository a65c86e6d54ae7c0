"""``qtab book``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from qtab import book
from qtab._utils.files import check_writable
from qtab._utils.progress import print_above
from qtab.cli.constructors import INT, OPTIONAL_INT
from qtab.cli.parsing import parse
from qtab.cli.usage import UsageError, usage_errors
from qtab.plots.axes import check_format

COMMAND = "qtab book"


@dataclass(frozen=True)
class Arguments:
    """Run an experiment of Sutton & Barto's book with the book's number of runs, and print the results."""

    experiment: Annotated[tyro.conf.Positional[str | None], tyro.conf.arg(metavar="NAME")] = None
    """figure-10.4, or 10.4 if no example has the same number; without a name, the experiments are listed."""
    runs: Annotated[int | None, OPTIONAL_INT] = None
    """The number of runs of each setting; by default as many as in the book."""
    seed: Annotated[int, INT] = 0
    """The seed of the first run; the other runs have the seeds after it."""
    plot: Path | None = None
    """Draw the figure to this file; its suffix determines the format."""
    save: Path | None = None
    """Write all points to this CSV file."""
    threads: Annotated[int | None, OPTIONAL_INT] = None
    """The number of threads; by default one per core. It does not change the results."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    if options.experiment is None and (options.plot is not None or options.save is not None):
        raise UsageError("NAME must be given with --plot or --save; qtab book lists the names")
    if options.experiment is None:
        for name, experiment in book.EXPERIMENTS.items():
            print_above(f"{name:14}{experiment.title}")
        return 0
    with usage_errors(("runs", "seed", "threads", "plot", "save"), "name"):
        experiment = book.find(options.experiment)
        if options.plot is not None:
            check_format("plot", options.plot)
            check_writable("plot", options.plot)
        if options.save is not None:
            check_writable("save", options.save)
        experiment.check_arguments(options.runs, options.seed, options.threads)
    result = experiment.run(options.runs, options.seed, threads=options.threads)
    print_above(str(result))
    if options.save is not None:
        result.save(options.save)
        print_above(f"Saved the points to {options.save}")
    if options.plot is not None:
        from qtab.book.drawing import save_plot

        save_plot(result, options.plot)
        print_above(f"Saved the plot to {options.plot}")
    return 0
