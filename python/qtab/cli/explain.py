"""``qtab explain``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from qtab.cli.constructors import INT
from qtab.cli.parsing import parse
from qtab.cli.reporting import OutputFlags, Report
from qtab.cli.usage import reading, usage_errors
from qtab.explanation.explain import explain
from qtab.results.storage import load

COMMAND = "qtab explain"


@dataclass(frozen=True)
class Arguments(OutputFlags):
    """Show steps of an episode of a saved run: why each action was chosen, and each update with its numbers."""

    run: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
    """A file written by qtab train --save."""
    episode: Annotated[int, INT] = 0
    """The number of the episode, from 0."""
    steps: Annotated[int, INT] = 5
    """How many steps to show."""
    start: Annotated[int, INT] = 0
    """The first of these steps, from 0."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with Report(COMMAND, options) as report:
        with usage_errors(("episode", "steps", "start"), "run"):
            with reading("RUN", options.run):
                saved = load(options.run)
            explanation = explain(saved, options.episode, options.steps, options.start)
        report.text(str(explanation))
        report.add(
            env=explanation.config.env,
            seed=explanation.config.seed,
            episode=explanation.episode,
            episode_length=explanation.episode_length,
            episode_return=explanation.episode_return,
            learning_rate=explanation.learning_rate,
            steps=explanation.steps,
        )
    return 0
