"""Show steps of an episode of a saved run: why each action was chosen, and each update with its numbers."""

from argparse import Namespace

from qtab.cli.errors import usage_errors
from qtab.cli.parser import Parser
from qtab.cli.reporting import Report
from qtab.cli.saved_run import add_run_and_env, load_run_and_env
from qtab.cli.values import integer
from qtab.explanation.explain import explain


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    add_run_and_env(parser)
    parser.output_flags()
    parser.option("episode", integer, "The number of the episode, from 0.", 0)
    parser.option("steps", integer, "The number of steps to show.", 5)
    parser.option("start", integer, "The first of these steps, from 0.", 0)


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with Report(options) as report:
        with usage_errors(options):
            explanation = explain(load_run_and_env(options), options.episode, options.steps, options.start)
        report.text(str(explanation))
        facts = ("episode", "episode_length", "episode_return", "learning_rate", "steps")
        report.add(env=explanation.config.env, seed=explanation.config.seed)
        report.add(**{name: getattr(explanation, name) for name in facts})
    return 0
