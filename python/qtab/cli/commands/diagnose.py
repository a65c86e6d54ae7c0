"""Look for reasons why a saved run did not solve its environment, and for changes to try."""

from argparse import Namespace
from typing import Any

import numpy as np

from qtab._utils import checks
from qtab.cli.errors import usage_errors
from qtab.cli.parser import Parser
from qtab.cli.reporting import Report
from qtab.cli.saved_run import add_run_and_env, load_run_and_env
from qtab.cli.values import integer
from qtab.diagnosis.diagnose import diagnose
from qtab.diagnosis.diagnosis import SEEDS, Diagnosis
from qtab.diagnosis.what_if import WhatIf


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    add_run_and_env(parser)
    parser.output_flags()
    parser.switch("what_if", "Also try the advised changes, one at a time, over many seeds.")
    parser.option("seeds", integer, "The number of seeds for --what-if.", SEEDS)


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with Report(options) as report:
        with usage_errors(options):
            if options.what_if:
                checks.integer("seeds", options.seeds, least=2)
            saved = load_run_and_env(options)
            diagnosis = diagnose(saved)
        report.text(str(diagnosis))
        facts = ("findings", "unremarkable", "not_made", "reasons", "seconds")
        report.add(env=saved.config.env, seed=saved.config.seed, what_if=None)
        report.add(**_returns(diagnosis), **{name: getattr(diagnosis, name) for name in facts})
        if options.what_if and any(finding.changes for finding in diagnosis):
            with usage_errors(options):
                tried = diagnosis.what_if(options.seeds, progress=report.progress)
            report.text(f"\n{tried}")
            report.add(what_if=_facts(tried))
    return 0


def _returns(diagnosis: Diagnosis) -> dict[str, Any]:
    """Returns the numbers of the verdict, and the return of the greedy policy also where there is no goal."""
    numbers, played = diagnosis.verdict.numbers(), diagnosis.facts.greedy
    if numbers["greedy_return"] is None and played is not None:
        numbers["greedy_return"] = float(played.returns.mean())
    return numbers


def _facts(tried: WhatIf) -> dict[str, Any]:
    """Returns the entry of the JSON object for the changes that were tried."""
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
