"""``qtab watch``, and what ``qtab record`` shares with it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from qtab._utils.progress import print_above
from qtab.cli.constructors import OPTIONAL_FLOAT, OPTIONAL_INT
from qtab.cli.parsing import parse
from qtab.cli.usage import UsageError, reading, usage_errors
from qtab.rendering.play import Playback, play
from qtab.rendering.window import display_problem
from qtab.results.run import Run
from qtab.results.storage import load

COMMAND = "qtab watch"
FLAGS = ("episodes", "seed", "fps", "max_episode_steps")
"""The arguments that messages spell as flags."""


@dataclass(frozen=True, kw_only=True)
class Arguments:
    """Show episodes that the greedy policy of a saved run plays in a window. Closing it ends the command."""

    run: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
    """A file written by qtab train --save."""
    episodes: int = 1
    """The number of episodes."""
    seed: Annotated[int | None, OPTIONAL_INT] = None
    """The seed of the environment; by default a random one, which is printed."""
    fps: Annotated[float | None, OPTIONAL_FLOAT] = None
    """Pictures per second; by default the environment's."""
    max_episode_steps: Annotated[int | None, OPTIONAL_INT] = None
    """The time limit of an episode in steps; by default that of the run."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with usage_errors(FLAGS):
        saved = load_run(options)
        problem = display_problem()
        if problem is not None:
            advice = f"qtab record {options.run} agent.mp4 writes a video without one"
            raise UsageError(f"a window needs a display ({problem}); {advice}")
        played = played_by(saved, options, window=True)
    print_above(played.summary)
    return 0


def load_run(options: Arguments) -> Run:
    """Returns the run of the file."""
    with reading("RUN", options.run):
        return load(options.run)


def played_by(saved: Run, options: Arguments, window: bool) -> Playback:
    """Plays the episodes that the arguments ask for."""
    limit = options.max_episode_steps
    return play(saved, options.episodes, options.seed, window=window, fps=options.fps, max_episode_steps=limit)
