"""The argument RUN of the commands that read a saved run."""

from argparse import Namespace

from qtab.cli.errors import reading
from qtab.cli.parser import Parser
from qtab.results.files.loading import load
from qtab.results.run import Run

ENV_OF_RUN = (
    "The environment's id with its package, package:Name-v0, if one registers it: loading a run imports no package."
)
"""The help of ``--env`` beside the file of a run."""


def add_run(parser: Parser) -> None:
    """Adds the argument."""
    parser.positional("run", "A file written by qtab train --save.")


def load_run(options: Namespace) -> Run:
    """Returns the run of the file."""
    with reading("RUN", options.run):
        return load(options.run)
