"""The argument RUN of the commands that read a saved run."""

from argparse import Namespace

import gymnasium as gym

from qtab.cli.errors import reading
from qtab.cli.parser import Parser
from qtab.envs.registry import spec_of
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


def add_run_and_env(parser: Parser) -> None:
    """Adds the argument, and the option ``--env`` of the commands that make the environment of the run."""
    add_run(parser)
    parser.option("env", str, ENV_OF_RUN, metavar="ENV")


def load_run_and_env(options: Namespace) -> Run:
    """Returns the run of the file, after importing the package of ``--env``, which registers its environment.

    Raises:
        ValueError: if ``--env`` is another environment.
    """
    saved, env = load_run(options), options.env
    if env is not None and not _is_env_of(saved, env):
        raise ValueError(f"env must be that of the run, {str(saved.config.env)!r}, got {env!r}")
    return saved


def _is_env_of(saved: Run, env: str) -> bool:
    try:
        return spec_of(env).id == saved.config.env.rpartition(":")[2]
    except gym.error.UnregisteredEnv:
        if env == saved.config.env:
            raise
        return False  # such as an id without its package, which is then not imported
