"""``qtab report``."""

from dataclasses import dataclass
from pathlib import Path

import tyro

from qtab._utils.progress import print_above
from qtab.cli.parsing import parse
from qtab.cli.usage import refusing
from qtab.sweeps import load_sweep
from qtab.sweeps.report import report

COMMAND = "qtab report"


@dataclass(frozen=True)
class Arguments:
    """Write a sweep's tables and pictures into a folder, with one HTML page that needs nothing else."""

    store: tyro.conf.Positional[Path]
    """The file that qtab sweep keeps its results in; the sweep may still be underway."""
    out: Path | None = None
    """The folder; the store's name with -report where it is not given."""


def run(arguments: list[str]) -> int:
    """Reports as the arguments say; returns the exit code."""
    asked = parse(Arguments, COMMAND, arguments)
    with refusing():
        folder = asked.out or asked.store.with_name(f"{asked.store.stem}-report")
        written = report(load_sweep(asked.store), folder)
    print_above(f"{len(written)} files in {folder}; open {written[-1]}")
    return 0
