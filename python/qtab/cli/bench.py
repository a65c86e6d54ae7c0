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
    """Time this package beside Gymnasium and the article's loop, in one process and in interleaved rounds."""

    seconds: float = DEFAULT_SECONDS
    """About how long the rounds take together."""
    rounds: int | None = None
    """Make so many rounds, however long they take."""
    part: str | None = None
    """Time this part alone: training, stepping, vectors, environments or learners."""


def run(arguments: list[str]) -> int:
    """Times as the arguments say; returns the exit code."""
    asked = parse(Arguments, COMMAND, arguments)
    try:
        report = bench(asked.seconds, asked.rounds, part=asked.part)
    except ValueError as error:
        raise UsageError(str(error)) from None
    print_above(str(report))
    return 0
