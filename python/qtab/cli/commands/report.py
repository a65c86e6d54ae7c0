"""Write the tables and plots of a sweep into a folder, with one self-contained HTML page."""

import shlex
from argparse import Namespace
from pathlib import Path

from qtab.cli.errors import usage_errors
from qtab.cli.parser import Parser
from qtab.cli.reporting import Report
from qtab.rendering.sweep_report import write_report
from qtab.sweeps import load_sweep


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    parser.positional("store", "The store of a qtab sweep, which may still be running.")
    parser.output_flags()
    parser.option("out", Path, "The folder; by default the name of the store with -report.", metavar="FOLDER")


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with Report(options) as output:
        with usage_errors(options):
            sweep = load_sweep(options.store)
            folder = options.out or options.store.with_name(f"{options.store.stem}-report")
            command = shlex.join([*options.command.split(), *options.words])
            files = write_report(sweep, folder, command)
        output.text(f"{len(files)} files in {folder}; open {files[-1]}")
        output.add(folder=folder, files=files)
    return 0
