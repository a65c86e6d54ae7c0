"""``qtab train``."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, make_dataclass
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import tyro

from qtab._utils.progress import print_above
from qtab.cli.outputs import Outputs
from qtab.cli.parsing import parse
from qtab.cli.settings import flag_groups, read_config, with_initial_q
from qtab.cli.usage import UsageError, usage_errors
from qtab.config import DEFAULTS, Config
from qtab.config.explanations import default, groups
from qtab.config.merge import merge
from qtab.config.options import is_set
from qtab.envs.registry import spec_of, versioned
from qtab.planning import Optimum, optimum
from qtab.results.run import Run
from qtab.results.summary import FINAL_EPISODES, default_block
from qtab.training.callbacks import Progress
from qtab.training.resolve import resolve, time_limit_notice
from qtab.training.resolved_run import NativeEnvironment, ResolvedRun
from qtab.training.train import train_resolved

COMMAND = "qtab train"
QUICK = 10**8
"""The number of updates up to which the optimum is computed without being asked for: less than a second."""
_HELP = ("-h", "--help")
_File: TypeAlias = Annotated[Path | None, tyro.conf.arg(metavar="FILE")]


@dataclass(frozen=True)
class Arguments:
    """Train a tabular agent. The defaults shown are those of the environment, the preset and the file given."""

    env: Annotated[
        str | None,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="[ENV]", help_behavior_hint=f"(default: {Config.env})"),
    ] = None
    """The environment's id in Gymnasium; --env ENV does as well."""
    env_flag: Annotated[str | None, tyro.conf.arg(name="env", metavar="ENV")] = None
    """The environment's id in Gymnasium."""
    config: _File = None
    """A TOML file of settings. Those given on the command line win over it."""
    plot: _File = None
    """Draw the learning curve to this file. Its ending gives the format."""
    save: _File = None
    """Save the run to this file, for qtab.load, qtab verify and --initial-q."""
    watch: Annotated[int | None, tyro.conf.arg(metavar="INT")] = None
    """Show this many of the last training episodes on the screen."""
    record: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    """Write the last training episodes, 20 or the number given by --watch, to videos in this folder."""
    optimum: bool = False
    """Report how far the run is from the optimum, and draw it. Small tables do this anyway."""


def run(arguments: list[str]) -> int:
    """Trains and reports; returns the exit code."""
    asked, env, settings = _parse(arguments)
    with usage_errors():
        resolved = resolve(env, with_initial_q(settings))
    try:
        with usage_errors():
            outputs = Outputs(resolved.config, asked.save, asked.plot, asked.watch, asked.record)
            truth = _truth(resolved) if asked.optimum or _quick(resolved) else None
        with outputs:
            print_above(_header(resolved))
            _train(resolved, outputs, truth)
    finally:
        resolved.close()
    return 0


def _parse(arguments: list[str]) -> tuple[Arguments, str, dict[str, Any]]:
    """Returns the arguments, the environment and the settings given, in the file or as flags."""
    words = [word for word in arguments if word not in _HELP]
    help_wanted = len(words) < len(arguments)
    try:
        asked = _read(words, DEFAULTS)
    except UsageError:
        if not help_wanted:
            raise
        asked = _read([], DEFAULTS)
    with usage_errors():
        env, settings = _given(asked)
    if help_wanted:
        with usage_errors():
            shown = _effective_defaults(env, settings)
        _read(["--help"], shown)  # leaves
    return asked, env, settings


def _read(words: list[str], shown: Mapping[str, Any]) -> Arguments:
    fields: list[Any] = [
        (title.lower(), flags, field(default_factory=dict)) for title, flags in flag_groups(shown).items()
    ]
    namespace = {"__doc__": Arguments.__doc__}
    with_settings = make_dataclass("Arguments", fields, bases=(Arguments,), frozen=True, namespace=namespace)
    return parse(with_settings, COMMAND, words, known=DEFAULTS)


def _given(asked: Arguments) -> tuple[str, dict[str, Any]]:
    settings = {} if asked.config is None else read_config(asked.config)
    for title in groups(DEFAULTS):
        settings |= getattr(asked, title.lower())
    if asked.env is not None and asked.env_flag is not None:
        raise ValueError(f"env must be given once, got {asked.env!r} and {asked.env_flag!r}")
    named = settings.pop("env", Config.env)
    return asked.env or asked.env_flag or named, settings


def _effective_defaults(env: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the values of the settings that are not given as flags."""
    env = versioned(env)
    given = {name: value for name, value in settings.items() if not isinstance(value, Path)}
    merged = vars(merge(env, {"env_kwargs": dict(spec_of(env).kwargs)}, given))
    shown = {name: value if is_set(value) else default(name) for name, value in merged.items()}
    return {**shown, **{name: settings[name] for name in settings.keys() - given.keys()}}


def _header(resolved: ResolvedRun) -> str:
    config = resolved.config
    backend = "in Rust" if config.backend == "rust" else "stepped by Gymnasium in Python"
    parts = [
        f"{config.env} {backend}",
        f"preset {config.preset}" if config.preset is not None else "no preset",
        _episodes(config.episodes),
        f"seed {config.seed}",
    ]
    header = ", ".join(parts)
    return f"{header}\n{time_limit_notice(resolved)}" if resolved.default_time_limit else header


def _quick(resolved: ResolvedRun) -> bool:
    environment = resolved.environment
    if not isinstance(environment, NativeEnvironment) or not environment.entry.has_table:
        return False
    return resolved.discretizer.n_rows * len(resolved.actions) * resolved.max_episode_steps <= QUICK


def _truth(resolved: ResolvedRun) -> Optimum:
    config = resolved.config
    return optimum(config.env, env_kwargs=config.env_kwargs, max_episode_steps=config.max_episode_steps)


def _train(resolved: ResolvedRun, outputs: Outputs, truth: Optimum | None) -> None:
    block = default_block(resolved.config.episodes)
    averages = _averages(block)
    try:
        finished = train_resolved(resolved, averages, block, record=outputs.shown)
    except BaseException as error:
        partial = getattr(error, "run", None)
        if isinstance(partial, Run):
            done, total = len(partial.episode_returns), partial.config.episodes
            averages(Progress(done, total, partial.episode_returns, partial.episode_lengths))
            print_above(f"Stopped after {done:,} of {total:,} episodes; what was learned so far:")
            _tell(partial, outputs, truth)
        raise
    _tell(finished, outputs, truth)
    outputs.show(finished)


def _tell(run: Run, outputs: Outputs, truth: Optimum | None) -> None:
    print_above(_summary(run))
    if truth is not None:
        gap = str(truth.gap(run))
        print_above(gap[0].upper() + gap[1:])
    outputs.keep(run, truth)


def _averages(block: int) -> Callable[[Progress], None]:
    """Returns a callback that prints the average return of each block of episodes, as the article does."""
    printed = 0

    def callback(progress: Progress) -> None:
        nonlocal printed
        while printed + block <= progress.episodes:
            average = float(progress.returns[printed : printed + block].mean())
            print_above(f"Episode {printed + block} Average Reward: {round(average, 4)}")
            printed += block  # last: a line that Ctrl-C cut off is written again

    return callback


def _summary(run: Run) -> str:
    returns, steps = run.episode_returns[-FINAL_EPISODES:], int(run.episode_lengths.sum())
    if len(returns) == 0:
        return f"No episode was finished in {run.seconds:.3g} s"
    speed = f" ({steps / run.seconds:,.0f} steps/s)" if run.seconds > 0 else ""
    took = f"{steps:,} steps in {run.seconds:.3g} s{speed}"
    return f"Mean return over the last {_episodes(len(returns))}: {returns.mean():.2f}; {took}"


def _episodes(count: int) -> str:
    return f"{count:,} episode{'' if count == 1 else 's'}"
