"""``qtab bench``."""

from dataclasses import dataclass
from typing import Annotated

from qtab.bench import bench
from qtab.bench.report import DEFAULT_SECONDS
from qtab.cli.constructors import FLOAT, OPTIONAL_INT
from qtab.cli.parsing import parse
from qtab.cli.reporting import OutputFlags, Report
from qtab.cli.usage import usage_errors

COMMAND = "qtab bench"


@dataclass(frozen=True)
class Arguments(OutputFlags):
    """Compare the speed of this package with Gymnasium and the article's loop, in interleaved rounds of one process."""

    seconds: Annotated[float, FLOAT] = DEFAULT_SECONDS
    """The approximate duration of all rounds."""
    rounds: Annotated[int | None, OPTIONAL_INT] = None
    """The number of rounds; by default as many as fit into the duration."""
    part: str | None = None
    """Run only this part: training, stepping, vectors, environments, learners or book."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with Report(COMMAND, options) as report:
        with usage_errors(("seconds", "rounds", "part")):
            found = bench(options.seconds, options.rounds, report.progress, options.part)
        report.add(**found.facts())
        report.text(str(found))
    return 0
