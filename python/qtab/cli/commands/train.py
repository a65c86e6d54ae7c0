"""Train a tabular agent. The defaults shown are those of the environment, the preset and the file given."""

from argparse import BooleanOptionalAction, Namespace
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from qtab._utils.shown import counted
from qtab.cli.command import parser_of
from qtab.cli.errors import UsageError, usage_errors
from qtab.cli.outputs import Outputs
from qtab.cli.parser import Parser
from qtab.cli.reporting import Report
from qtab.cli.settings import add_settings, given_settings, read_config, with_initial_q
from qtab.cli.training_report import OPTIMUM, Training, backend_words, optimum_of
from qtab.cli.values import integer
from qtab.config import DEFAULTS, Config
from qtab.config.help import default
from qtab.config.merge import merge
from qtab.config.options import is_set
from qtab.config.validation import defaults
from qtab.envs.registry import named_spec
from qtab.results.recording import snapshot_episodes
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import ResolvedRun, time_limit_notice


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    parser.positional("env", f"The environment's id in Gymnasium (default: {Config.env}).", str, default=None)
    parser.output_flags()
    parser.add_argument("--env", dest="env_flag", metavar="ENV", help="The environment's id, given as an option.")
    parser.option("config", Path, "A TOML file of settings. Flags override it.")
    parser.option("plot", Path, "Draw the learning curve to this file; its suffix sets the format.")
    save = (
        "Save the run to this file, for qtab.load, qtab verify and --initial-q. Ctrl-C saves what was learned so far."
    )
    parser.option("save", Path, save)
    every = "Save the run so far to the file of --save each time this many more episodes are finished."
    parser.option("checkpoint", integer, every, metavar="EPISODES")
    parser.option("watch", integer, "Show this many of the last training episodes on the screen.")
    record = "Write the last training episodes, 20 or the number given by --watch, to videos in this folder."
    parser.option("record", Path, record, metavar="FOLDER")
    visits = "Count how often each action was taken in each cell, for the file of --save."
    parser.add_argument("--visits", action=BooleanOptionalAction, default=False, help=visits)
    snapshots = "Keep this many copies of the tables, evenly spaced over the episodes, in the file of --save."
    parser.option("snapshots", integer, snapshots)
    parser.add_argument("--optimum", action=BooleanOptionalAction, default=False, help=OPTIMUM)
    add_settings(parser, shown_defaults(parser.words) if parser.help_wanted else DEFAULTS)


def run(asked: Namespace) -> int:
    """Trains and reports; returns the exit code."""
    with usage_errors():
        env, settings = env_and_settings(asked)
    asked.flags = _flags(asked, settings)
    with Report(asked) as report:
        with usage_errors(asked):
            resolved = resolve(env, with_initial_q(settings))
        with closing(resolved):
            with usage_errors(asked):
                outputs = Outputs(resolved.config, asked, report)
                snapshots = snapshot_episodes(asked.snapshots, resolved.config.episodes)
                best = optimum_of(resolved, asked.optimum, report.progress)
            with outputs:
                report.text(_header(resolved))
                Training(resolved, report, outputs, best, asked.visits, snapshots).run()
    return 0


def shown_defaults(words: Sequence[str]) -> Mapping[str, Any]:
    """Returns the defaults that ``--help`` shows: those of the given environment, preset and file.

    Raises:
        UsageError: for settings that do not fit, and a file that cannot be read.
    """
    try:
        asked = parser_of("train", words).read()
    except UsageError:
        asked = parser_of("train").read()
    with usage_errors():
        env, settings = env_and_settings(asked)
    asked.flags = _flags(asked, settings)
    with usage_errors(asked):
        return _effective_defaults(env, settings)


def env_and_settings(asked: Namespace) -> tuple[str, dict[str, Any]]:
    """Returns the environment, and the settings given as flags or in the file."""
    settings = {} if asked.config is None else read_config(asked.config)
    settings |= given_settings(asked)
    if asked.env is not None and asked.env_flag is not None:
        raise ValueError(f"env must be given once, got {asked.env!r} and {asked.env_flag!r}")
    named = settings.pop("env", Config.env)
    if not isinstance(named, str):
        raise TypeError(f"env must be an environment id, got {named!r}")
    return asked.env or asked.env_flag or named, settings


def _flags(asked: Namespace, settings: Mapping[str, Any]) -> tuple[str, ...]:
    """Returns the arguments that messages spell as flags: all but the settings given only in the file."""
    in_file = settings.keys() - given_settings(asked).keys()
    return tuple(name for name in asked.flags if name not in in_file and name != "env")


def _effective_defaults(env: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the values of the settings that are not given as flags."""
    env, spec = named_spec(env)
    given = {name: value for name, value in settings.items() if not isinstance(value, Path)}
    merged = dict(vars(merge(env, {"env_kwargs": dict(spec.kwargs)}, given)))
    merged |= defaults(merged)
    shown = {name: value if is_set(value) else default(name) for name, value in merged.items()}
    return {**shown, **{name: settings[name] for name in settings.keys() - given.keys()}}


def _header(resolved: ResolvedRun) -> str:
    config = resolved.config
    parts = [
        backend_words(config),
        f"preset {config.preset}" if config.preset is not None else "no preset",
        counted(config.episodes, "episode"),
        f"seed {config.seed}",
    ]
    header = ", ".join(parts)
    return f"{header}\n{time_limit_notice(resolved)}" if resolved.default_time_limit else header
