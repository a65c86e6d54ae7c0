"""``qtab report``."""

import shlex
from dataclasses import dataclass
from pathlib import Path

import tyro

from qtab.cli.parsing import parse
from qtab.cli.reporting import OutputFlags, Report
from qtab.cli.usage import usage_errors
from qtab.sweeps import load_sweep
from qtab.sweeps.report import report

COMMAND = "qtab report"


@dataclass(frozen=True)
class Arguments(OutputFlags):
    """Write the tables and plots of a sweep into a folder, with one self-contained HTML page."""

    store: tyro.conf.Positional[Path]
    """The store of a qtab sweep, which may still be running."""
    out: Path | None = None
    """The folder; by default the name of the store with -report."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with Report(COMMAND, options) as output:
        with usage_errors():
            folder = options.out or options.store.with_name(f"{options.store.stem}-report")
            command = shlex.join(["qtab", "report", *arguments])
            files = report(load_sweep(options.store), folder, command)
        output.text(f"{len(files)} files in {folder}; open {files[-1]}")
        output.add(folder=folder, files=files)
    return 0
