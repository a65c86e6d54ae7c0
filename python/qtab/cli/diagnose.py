"""``qtab diagnose``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from qtab._utils import checks
from qtab.cli.constructors import INT
from qtab.cli.parsing import parse
from qtab.cli.reporting import OutputFlags, Report
from qtab.cli.usage import reading, usage_errors
from qtab.diagnosis.diagnose import diagnose
from qtab.diagnosis.diagnosis import SEEDS
from qtab.diagnosis.what_if import WhatIf
from qtab.results.storage import load

COMMAND = "qtab diagnose"


@dataclass(frozen=True)
class Arguments(OutputFlags):
    """Look for reasons why a saved run did not solve its environment, and for what to change."""

    run: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
    """A file written by qtab train --save."""
    what_if: tyro.conf.FlagCreatePairsOff[bool] = False
    """Also try the advised changes, one at a time, over many seeds."""
    seeds: Annotated[int, INT] = SEEDS
    """The number of seeds for --what-if."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with Report(COMMAND, options) as report:
        with usage_errors(("seeds",), "run"):
            if options.what_if:
                checks.integer("seeds", options.seeds, least=2)
            with reading("RUN", options.run):
                saved = load(options.run)
            diagnosis = diagnose(saved)
        report.text(str(diagnosis))
        facts = ("findings", "unremarkable", "not_made", "reasons", "seconds")
        report.add(env=saved.config.env, seed=saved.config.seed, what_if=None)
        report.add(**diagnosis.verdict.numbers(), **{name: getattr(diagnosis, name) for name in facts})
        if options.what_if and any(finding.changes for finding in diagnosis):
            with usage_errors(("seeds",)):
                tried = diagnosis.what_if(options.seeds, progress=report.progress)
            report.text(f"\n{tried}")
            report.add(what_if=_facts(tried))
    return 0


def _facts(tried: WhatIf) -> dict[str, Any]:
    """Returns what the JSON object says of the changes that were tried."""
    return {
        "seeds": tried.seeds,
        "mean_return": float(np.mean(tried.returns)),
        "solved": tried.solved,
        "results": [
            {
                "change": trial.change,
                "finding": trial.finding,
                "mean_return": float(np.mean(trial.returns)),
                "difference": None if trial.comparison is None else trial.comparison.difference,
                "solved": trial.solved,
            }
            for trial in tried.results
        ],
        "failed": tried.failed,
    }
