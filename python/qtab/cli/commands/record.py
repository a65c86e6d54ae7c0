"""Write a video of episodes that the greedy policy of a saved run plays. No display is needed."""

from argparse import Namespace

from qtab._utils.progress import print_above
from qtab.cli.commands import watch
from qtab.cli.errors import usage_errors
from qtab.cli.parser import Parser
from qtab.cli.saved_run import load_run_and_env
from qtab.rendering.formats import check_video_path


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    watch.add_arguments(parser)
    path = "The file to write, which ends in .mp4, .gif or .html; the last is a page with a player."
    parser.positional("path", path)


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with usage_errors(options):
        saved = load_run_and_env(options)
        check_video_path(options.path)
        played = watch.played_by(saved, options, window=False)
    played.save(options.path)
    print_above(f"{played.summary}\nSaved the video to {options.path}")
    return 0
