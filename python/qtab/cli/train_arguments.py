"""The arguments of ``qtab train``: what is not a setting, and the settings as flags or in a file."""

from collections.abc import Mapping
from dataclasses import dataclass, field, make_dataclass
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import tyro

from qtab.cli.constructors import OPTIONAL_INT
from qtab.cli.parsing import parse
from qtab.cli.reporting import OutputFlags
from qtab.cli.settings import flag_groups, given_flags, read_config
from qtab.cli.usage import UsageError, usage_errors
from qtab.config import DEFAULTS, Config
from qtab.config.explanations import default, groups
from qtab.config.merge import merge
from qtab.config.options import is_set
from qtab.envs.registry import spec_of, versioned

COMMAND = "qtab train"
_HELP = ("-h", "--help")
_File: TypeAlias = Annotated[Path | None, tyro.conf.arg(metavar="FILE")]


@dataclass(frozen=True)
class Arguments(OutputFlags):
    """Train a tabular agent. The defaults shown are those of the environment, the preset and the file given."""

    env: Annotated[
        str | None,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="[ENV]", help_behavior_hint=f"(default: {Config.env})"),
    ] = None
    """The environment's id in Gymnasium; --env ENV is equivalent."""
    env_flag: Annotated[str | None, tyro.conf.arg(name="env", metavar="ENV")] = None
    """The environment's id in Gymnasium."""
    config: _File = None
    """A TOML file of settings. Flags override it."""
    plot: _File = None
    """Draw the learning curve to this file. Its ending gives the format."""
    save: _File = None
    """Save the run to this file, for qtab.load, qtab verify and --initial-q. Ctrl-C saves what was learned so far."""
    checkpoint: Annotated[int | None, tyro.conf.arg(metavar="EPISODES")] = None
    """Save the run so far to the file of --save each time this many more episodes are finished."""
    watch: Annotated[int | None, OPTIONAL_INT] = None
    """Show this many of the last training episodes on the screen."""
    record: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    """Write the last training episodes, 20 or the number given by --watch, to videos in this folder."""
    visits: bool = False
    """Count how often each action was taken in each cell, for the file of --save."""
    snapshots: Annotated[int | None, tyro.conf.arg(metavar="INT")] = None
    """Keep this many copies of the tables, evenly spaced over the episodes, in the file of --save."""
    optimum: bool = False
    """Report how far the run is from the optimum, and draw it. Always done for small tables."""


OUTPUTS = ("save", "checkpoint", "plot", "watch", "record")
"""The arguments that are not settings and say where a run is written or shown."""


def flags_of(asked: Arguments) -> tuple[str, ...]:
    """Returns the arguments that messages spell as flags: all but the settings that only the file gives."""
    given = {name for title in groups(DEFAULTS) for name in given_flags(getattr(asked, title.lower()))}
    in_file = () if asked.config is None else read_config(asked.config).keys() - given
    return (*OUTPUTS, *(name for name in DEFAULTS if name not in in_file and name != "env"))


def parse_arguments(arguments: list[str]) -> tuple[Arguments, str, dict[str, Any]]:
    """Returns the arguments, the environment, and the settings given as flags or in the file.

    ``--help`` prints the help, with the defaults of the environment, the preset and the file given, and exits.

    Raises:
        UsageError: for arguments that cannot be parsed, and a file that cannot be read.
    """
    words = [word for word in arguments if word not in _HELP]
    help_wanted = len(words) < len(arguments)
    try:
        asked = _read(words, DEFAULTS)
    except UsageError:
        if not help_wanted:
            raise
        asked = _read([], DEFAULTS)
    with usage_errors():
        env, settings = _env_and_settings(asked)
    if help_wanted:
        with usage_errors(flags_of(asked)):
            shown = _effective_defaults(env, settings)
        _read(["--help"], shown)
    return asked, env, settings


def _read(words: list[str], shown: Mapping[str, Any]) -> Arguments:
    fields: list[Any] = [
        # Without a help text, tyro would look for one in the source.
        (title.lower(), flags, field(default_factory=flags, metadata={"help": ""}))
        for title, flags in flag_groups(shown).items()
    ]
    namespace = {"__doc__": Arguments.__doc__}
    with_settings = make_dataclass("Arguments", fields, bases=(Arguments,), frozen=True, namespace=namespace)
    return parse(with_settings, COMMAND, words, known=DEFAULTS)


def _env_and_settings(asked: Arguments) -> tuple[str, dict[str, Any]]:
    settings = {} if asked.config is None else read_config(asked.config)
    for title in groups(DEFAULTS):
        settings |= given_flags(getattr(asked, title.lower()))
    if asked.env is not None and asked.env_flag is not None:
        raise ValueError(f"env must be given once, got {asked.env!r} and {asked.env_flag!r}")
    named = settings.pop("env", Config.env)
    if not isinstance(named, str):
        raise TypeError(f"env must be an environment id, got {named!r}")
    return asked.env or asked.env_flag or named, settings


def _effective_defaults(env: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the values of the settings that are not given as flags."""
    env = versioned(env)
    given = {name: value for name, value in settings.items() if not isinstance(value, Path)}
    merged = vars(merge(env, {"env_kwargs": dict(spec_of(env).kwargs)}, given))
    shown = {name: value if is_set(value) else default(name) for name, value in merged.items()}
    return {**shown, **{name: settings[name] for name in settings.keys() - given.keys()}}
