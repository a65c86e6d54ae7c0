"""Run an experiment of Sutton & Barto's book, and print the results."""

from argparse import Namespace
from pathlib import Path

from qtab import book
from qtab._utils.files import check_writable
from qtab._utils.progress import print_above
from qtab.book.registry import same_number
from qtab.cli.errors import UsageError, usage_errors
from qtab.cli.parser import Parser
from qtab.cli.values import integer
from qtab.plots.parts.axes import check_format

ALL = "all"


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    name = "figure-10.4; 10.4, which is the figure if an example has this number; or all. Without a name, lists them."
    parser.positional("experiment", name, str, default=None, metavar="NAME")
    parser.option("runs", integer, "The number of runs of each setting; by default that of the full figure.")
    parser.option("seed", integer, "The seed of the first run; the other runs have the seeds after it.", 0)
    parser.option("plot", Path, "Draw the figure to this file; its suffix determines the format.")
    parser.option("save", Path, "Write all points to this CSV file.")
    out = "With all: the folder for each experiment's table, points and picture; those already there are skipped."
    parser.option("out", Path, out, metavar="FOLDER")
    threads = "The number of threads; by default one per core. It does not change the results."
    parser.option("threads", integer, threads)


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    if options.experiment is None:
        if any(path is not None for path in (options.plot, options.save, options.out)):
            raise UsageError("NAME must be given with --plot, --save or --out; qtab book lists the names")
        _list()
        return 0
    if options.experiment == ALL:
        return _run_all(options)
    if options.out is not None:
        raise UsageError("--out must be left out, except with qtab book all; --plot and --save write single files")
    with usage_errors(options):
        experiment = book.find(options.experiment)
        if options.plot is not None:
            check_format("plot", options.plot)
            check_writable("plot", options.plot)
        if options.save is not None:
            check_writable("save", options.save)
        experiment.check_arguments(options.runs, options.seed, options.threads)
    if options.experiment.strip() == experiment.number:
        for other in same_number(experiment):
            kind = other.name.partition("-")[0]
            print_above(f"{experiment.number} is {experiment.name}; qtab book {other.name} runs the {kind}")
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


def _list() -> None:
    """Prints the experiments of each chapter."""
    for chapter in book.CHAPTERS:
        print_above(f"Chapter {chapter.number}: {chapter.title}")
        for experiment in chapter.experiments:
            print_above(f"  {experiment.name:14}{experiment.title}")


def _run_all(options: Namespace) -> int:
    if options.out is None or options.plot is not None or options.save is not None:
        raise UsageError("--out must name a folder for qtab book all, without --plot and --save")
    with usage_errors(options):
        book.run_all(options.out, options.runs, options.seed, threads=options.threads, on_start=_announce)
    print_above(f"Saved {len(book.EXPERIMENTS)} experiments to {options.out}")
    return 0


def _announce(experiment: book.Experiment, done: bool) -> None:
    print_above(f"{experiment.heading}{' (already there)' if done else ''}")
