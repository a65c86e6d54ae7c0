"""``qtab explain``."""

from dataclasses import dataclass
from pathlib import Path

import tyro

from qtab._utils.progress import print_above
from qtab.cli.parsing import parse
from qtab.cli.usage import usage_errors
from qtab.explanation.explain import explain
from qtab.results.storage import load

COMMAND = "qtab explain"


@dataclass(frozen=True)
class Arguments:
    """Show steps of an episode of a saved run: why each action was chosen, and each update with its numbers."""

    run: tyro.conf.Positional[Path]
    """A file written by qtab train --save."""
    episode: int = 0
    """The number of the episode, from 0."""
    steps: int = 5
    """How many steps to show."""
    start: int = 0
    """The first of these steps, from 0."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with usage_errors():
        explanation = explain(load(options.run), options.episode, options.steps, options.start)
    print_above(str(explanation))
    return 0
