"""``qtab record``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from qtab._utils.progress import print_above
from qtab.cli import watch
from qtab.cli.parsing import parse
from qtab.cli.usage import usage_errors
from qtab.rendering.formats import check_video_path

COMMAND = "qtab record"


@dataclass(frozen=True, kw_only=True)
class Arguments(watch.Arguments):
    """Write a video of episodes that the greedy policy of a saved run plays. No display is needed."""

    path: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="PATH")]
    """The file to write, which ends in .mp4, .gif or .html; the last is a page with a player."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with usage_errors(watch.FLAGS, "path"):
        saved = watch.load_run(options)
        check_video_path(options.path)
        played = watch.played_by(saved, options, window=False)
    played.save(options.path)
    print_above(f"{played.summary}\nSaved the video to {options.path}")
    return 0
