"""``qtab bench``."""

from dataclasses import dataclass

from qtab._utils.progress import print_above
from qtab.bench import bench
from qtab.bench.report import DEFAULT_SECONDS
from qtab.cli.parsing import parse
from qtab.cli.usage import UsageError

COMMAND = "qtab bench"


@dataclass(frozen=True)
class Arguments:
    """Compare the speed of this package with Gymnasium and the article's loop, in interleaved rounds of one process."""

    seconds: float = DEFAULT_SECONDS
    """The approximate duration of all rounds."""
    rounds: int | None = None
    """The number of rounds; by default as many as fit into the duration."""
    part: str | None = None
    """Run only this part: training, stepping, vectors, environments or learners."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    try:
        report = bench(options.seconds, options.rounds, part=options.part)
    except ValueError as error:
        raise UsageError(str(error)) from None
    print_above(str(report))
    return 0
