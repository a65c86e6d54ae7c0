"""Write a video of episodes that the greedy policy of a saved run plays. No display is needed."""

from qtab._utils.progress import print_above
from qtab.cli.commands import watch
from qtab.cli.errors import usage_errors
from qtab.cli.parser import Parser
from qtab.rendering.formats import check_video_path


def parser() -> Parser:
    """Returns the parser of ``qtab record``."""
    parser = Parser("record", __doc__)
    watch.add_arguments(parser)
    path = "The file to write, which ends in .mp4, .gif or .html; the last is a page with a player."
    parser.positional("path", path)
    return parser


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parser().read(arguments)
    with usage_errors(watch.FLAGS, "path"):
        saved = watch.load_run(options)
        check_video_path(options.path)
        played = watch.played_by(saved, options, window=False)
    played.save(options.path)
    print_above(f"{played.summary}\nSaved the video to {options.path}")
    return 0
