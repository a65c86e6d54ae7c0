"""``qtab verify``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from qtab._utils.progress import ProgressBar
from qtab.cli.constructors import OPTIONAL_INT
from qtab.cli.parsing import parse
from qtab.cli.reporting import OutputFlags, Report
from qtab.cli.usage import reading, usage_errors
from qtab.results.storage import load
from qtab.training.verify import verify

COMMAND = "qtab verify"


@dataclass(frozen=True)
class Arguments(OutputFlags):
    """Repeat a saved run with Gymnasium and NumPy, and compare the results; the exit code is 1 if they differ."""

    run: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
    """A file written by qtab train --save."""
    episodes: Annotated[int | None, OPTIONAL_INT] = None
    """Compare only the first episodes, using the schedules of the full run."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with Report(COMMAND, options) as report:
        with usage_errors(("episodes",), "run"):
            with reading("RUN", options.run):
                saved = load(options.run)
            total = options.episodes if options.episodes is not None else len(saved.episode_returns)
            with ProgressBar(total, "episode", report.progress, "Gymnasium") as bar:
                verification = verify(saved, options.episodes, progress=lambda done, _: bar.move_to(done))
        report.text(str(verification))
        report.add(**vars(verification), equal=verification.equal)
    return 0 if verification.equal else 1
