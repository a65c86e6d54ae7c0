"""``qtab bench``."""

from dataclasses import dataclass
from typing import Annotated

from qtab._utils.progress import print_above
from qtab.bench import bench
from qtab.bench.report import DEFAULT_SECONDS
from qtab.cli.constructors import FLOAT, OPTIONAL_INT
from qtab.cli.parsing import parse
from qtab.cli.usage import usage_errors

COMMAND = "qtab bench"


@dataclass(frozen=True)
class Arguments:
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
    with usage_errors(("seconds", "rounds", "part")):
        report = bench(options.seconds, options.rounds, part=options.part)
    print_above(str(report))
    return 0
