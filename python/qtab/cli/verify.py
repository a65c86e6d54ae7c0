"""``qtab verify``."""

from dataclasses import dataclass
from pathlib import Path

import tyro

from qtab._utils.progress import ProgressBar, print_above
from qtab.cli.parsing import parse
from qtab.cli.usage import refusing
from qtab.results.storage import load
from qtab.training.verify import verify

COMMAND = "qtab verify"


@dataclass(frozen=True)
class Arguments:
    """Replay a saved run through Gymnasium and NumPy; the exit code is 1 where the two sides differ."""

    run: tyro.conf.Positional[Path]
    """The file that qtab train --save wrote."""
    episodes: int | None = None
    """Compare only so many episodes, with the schedule of the full run."""


def run(arguments: list[str]) -> int:
    """Verifies as the arguments say; returns the exit code."""
    asked = parse(Arguments, COMMAND, arguments)
    with refusing():
        saved = load(asked.run)
        total = asked.episodes if asked.episodes is not None else len(saved.episode_returns)
        with ProgressBar(total, "episode", None, "Gymnasium") as shown:
            verification = verify(saved, asked.episodes, progress=lambda done, _: shown.move_to(done))
    print_above(str(verification))
    return 0 if verification.equal else 1
