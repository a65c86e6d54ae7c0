"""``qtab diagnose``."""

from dataclasses import dataclass
from pathlib import Path

import tyro

from qtab._utils.progress import print_above
from qtab.cli.parsing import parse
from qtab.cli.usage import usage_errors
from qtab.diagnosis.diagnose import diagnose
from qtab.diagnosis.diagnosis import SEEDS
from qtab.results.storage import load

COMMAND = "qtab diagnose"


@dataclass(frozen=True)
class Arguments:
    """Look for reasons why a saved run did not solve its environment, and for what to change."""

    run: tyro.conf.Positional[Path]
    """A file written by qtab train --save."""
    what_if: bool = False
    """Also try the advised changes, one at a time, over many seeds."""
    seeds: int = SEEDS
    """The number of seeds for --what-if."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with usage_errors():
        diagnosis = diagnose(load(options.run))
    print_above(str(diagnosis))
    if options.what_if and any(finding.changes for finding in diagnosis):
        with usage_errors():
            tried = diagnosis.what_if(options.seeds)
        print_above(f"\n{tried}")
    return 0
