"""Show steps of an episode of a saved run: why each action was chosen, and each update with its numbers."""

from argparse import Namespace

from qtab.cli.errors import reading, usage_errors
from qtab.cli.parser import Parser
from qtab.cli.reporting import Report
from qtab.cli.values import integer
from qtab.explanation.explain import explain
from qtab.results.loading import load


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    parser.positional("run", "A file written by qtab train --save.")
    parser.output_flags()
    parser.option("episode", integer, "The number of the episode, from 0.", 0)
    parser.option("steps", integer, "The number of steps to show.", 5)
    parser.option("start", integer, "The first of these steps, from 0.", 0)


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with Report(options) as report:
        with usage_errors(options):
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
