"""Show episodes that the greedy policy of a saved run plays in a window. Closing it ends the command."""

from argparse import Namespace

from qtab._utils.progress import print_above
from qtab.cli.errors import UsageError, usage_errors
from qtab.cli.parser import Parser
from qtab.cli.saved_run import add_run_and_env, load_run_and_env
from qtab.cli.values import integer, number
from qtab.rendering.play import Playback, play
from qtab.rendering.window import display_problem
from qtab.results.run import Run


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command, which ``qtab record`` has as well."""
    add_run_and_env(parser)
    parser.option("episodes", integer, "The number of episodes.", 1)
    parser.option("seed", integer, "The seed of the environment; by default a random one, which is printed.")
    parser.option("fps", number, "Pictures per second; by default the environment's.")
    limit = "The time limit of an episode in steps; by default that of the run."
    parser.option("max_episode_steps", integer, limit)


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with usage_errors(options):
        saved = load_run_and_env(options)
        problem = display_problem()
        if problem is not None:
            given = "" if options.env is None else f" --env {options.env}"
            advice = f"qtab record {options.run} agent.mp4{given} writes a video without one"
            raise UsageError(f"a window needs a display ({problem}); {advice}")
        played = played_by(saved, options, window=True)
    print_above(played.summary)
    return 0


def played_by(saved: Run, options: Namespace, window: bool) -> Playback:
    """Plays the episodes that the arguments ask for."""
    limit = options.max_episode_steps
    return play(saved, options.episodes, options.seed, window=window, fps=options.fps, max_episode_steps=limit)
