"""Repeat a saved run with Gymnasium and NumPy, and compare the results; the exit code is 1 if they differ."""

import logging
import time
from argparse import Namespace
from collections.abc import Callable

from qtab._utils.progress import ProgressBar
from qtab.cli.errors import usage_errors
from qtab.cli.parser import Parser
from qtab.cli.reporting import Report
from qtab.cli.saved_run import add_run_and_env, load_run_and_env
from qtab.cli.values import integer
from qtab.training.verify import verify

SILENT_SECONDS = 2.0
"""After this time without a progress bar, a message reports how long it will take."""


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    add_run_and_env(parser)
    parser.output_flags()
    parser.option("episodes", integer, "Compare only the first episodes, using the schedules of the full run.")


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with Report(options) as report:
        with usage_errors(options):
            saved = load_run_and_env(options)
            total = options.episodes if options.episodes is not None else len(saved.episode_returns)
            with ProgressBar(total, "episode", report.progress, "Gymnasium") as bar:
                announce = _announcer(saved.config.env, bar)
                verification = verify(saved, options.episodes, progress=announce)
        report.text(str(verification))
        report.add(**vars(verification), equal=verification.equal)
    return 0 if verification.equal else 1


def _announcer(env: str, bar: ProgressBar) -> Callable[[int, int], None]:
    """Returns the callback of :func:`qtab.verify` that advances a bar; if none is shown, it reports once."""
    began, announced = time.monotonic(), bar.is_shown

    def callback(done: int, total: int) -> None:
        nonlocal announced
        bar.move_to(done)
        seconds = time.monotonic() - began
        if not announced and done and seconds > SILENT_SECONDS:
            announced = True
            logging.getLogger("qtab").warning(
                "%s is stepped in Python to verify the run: %s of %s episodes took %.2g s, all will take about %.2g s",
                *(env, f"{done:,}", f"{total:,}", seconds, seconds / done * total),
            )

    return callback
