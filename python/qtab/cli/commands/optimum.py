"""Compute the best policy of an environment: exact from its transition table, or the best known."""

from argparse import Namespace

from qtab.cli.errors import usage_errors
from qtab.cli.parser import Parser, Together
from qtab.cli.reporting import Report
from qtab.cli.values import integer, number, pairs
from qtab.config import Config
from qtab.planning import optimum

FACTS = (
    *("env", "env_kwargs", "max_episode_steps", "discount", "method", "exact", "label"),
    *("expected_return", "reward_threshold", "seconds"),
)
"""The keys of the JSON object, besides the stationary policy of a transition table."""


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    parser.positional("env", "Gymnasium's id of the environment.", str, default=Config.env)
    parser.output_flags()
    words = "Keyword arguments of the environment's constructor."
    parser.add_argument(
        "--env-kwargs", action=Together, nargs="*", read=pairs, default={}, metavar="KEY VALUE", help=words
    )
    limit = "The time limit in steps; by default the environment's own, or 10,000 if it has none."
    parser.option("max_episode_steps", integer, limit)
    parser.option("discount", number, "The discount of the values and the policy; by default 1, no discount.")
    method = (
        "With a table, finite_horizon (the default), value_iteration or policy_iteration; for classic control, search."
    )
    parser.option("method", str, method)


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with Report(options) as report:
        with usage_errors(options):
            result = optimum(
                options.env,
                discount=options.discount,
                max_episode_steps=options.max_episode_steps,
                method=options.method,
                env_kwargs=options.env_kwargs,
                progress=report.progress,
            )
        report.text(str(result))
        report.add(**{name: getattr(result, name) for name in FACTS})
        stationary = result.stationary
        if stationary is not None:
            report.add(stationary_return=stationary.expected_return, stationary_proven=stationary.proven)
    return 0
