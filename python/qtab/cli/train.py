"""``qtab train``."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import tyro

from qtab._utils.progress import print_above
from qtab.cli.outputs import Outputs
from qtab.cli.parsing import parse
from qtab.cli.settings import Settings, defaults, last_value
from qtab.cli.usage import refusing
from qtab.envs.registry import versioned
from qtab.planning import Optimum, optimum
from qtab.results.run import Run
from qtab.results.summary import FINAL_EPISODES, default_block
from qtab.training.callbacks import Progress
from qtab.training.resolve import Resolved, limit, resolve
from qtab.training.train import train_resolved

COMMAND = "qtab train"
QUICK = 10**8
"""So many looks at a state and an action take less than a second: the optimum is computed unasked."""


@dataclass(frozen=True)
class Arguments:
    """Train a tabular agent. The defaults shown are those of the environment, the preset and the file given."""

    settings: Annotated[Settings, tyro.conf.arg(name="")]
    config: Path | None = None
    """A TOML file of the settings below; flags win over it."""
    plot: Path | None = None
    """Draw the learning curve to this file; its ending gives the format."""
    save: Path | None = None
    """Save the run to this file, for qtab.load, qtab verify and --initial-q."""
    watch: int | None = None
    """Show this many of the last training episodes on the screen."""
    record: Path | None = None
    """Write the last training episodes, 20 or as many as --watch says, to videos in this folder."""
    optimum: bool = False
    """Say how far the run is from the optimum, and draw it; from a table, where it is quick, this is done unasked."""


def run(arguments: list[str]) -> int:
    """Trains as the arguments say; returns the exit code."""
    asked = _parse(arguments)
    with refusing():
        resolved = resolve(asked.settings.env, asked.settings.overrides())
    try:
        with refusing():
            outputs = Outputs(resolved.config, asked.save, asked.plot, asked.watch, asked.record)
            truth = _truth(resolved) if asked.optimum or _quick(resolved) else None
        with outputs:
            print_above(_header(resolved))
            _train(resolved, outputs, truth)
    finally:
        resolved.close()
    return 0


def _parse(arguments: list[str]) -> Arguments:
    """Reads the arguments twice where need be: the environment that they name decides the defaults."""
    named = last_value(arguments, "--env")
    if named is not None:
        arguments = _without_env(arguments)
        arguments.insert(0, named)
    preset, file = last_value(arguments, "--preset"), last_value(arguments, "--config")
    env = arguments[0] if arguments and not arguments[0].startswith("-") else None
    while True:
        with refusing():
            start = defaults(env, preset, Path(file) if file is not None else None)
        asked = parse(Arguments, COMMAND, arguments, default=Arguments(start))
        with refusing():
            env = versioned(asked.settings.env)
        if env == start.env:
            return replace(asked, settings=replace(asked.settings, env=env))


def _without_env(arguments: list[str]) -> list[str]:
    kept, skip = [], False
    for word in arguments:
        if not skip and word != "--env" and not word.startswith("--env="):
            kept.append(word)
        skip = word == "--env"
    return kept


def _header(resolved: Resolved) -> str:
    config = resolved.config
    backend = "in Rust" if config.backend == "rust" else "stepped by Gymnasium in Python"
    parts = [
        f"{config.env} {backend}",
        f"preset {config.preset}" if config.preset is not None else "no preset",
        _episodes(config.episodes),
        f"seed {config.seed}",
    ]
    header = ", ".join(parts)
    return f"{header}\n{limit(resolved)}" if resolved.limited else header


def _quick(resolved: Resolved) -> bool:
    if resolved.model is None or not resolved.model.has_table or resolved.config.max_episode_steps is None:
        return False
    return resolved.grid.rows * resolved.grid.actions * resolved.config.max_episode_steps <= QUICK


def _truth(resolved: Resolved) -> Optimum:
    config = resolved.config
    return optimum(config.env, env_kwargs=config.env_kwargs, max_episode_steps=config.max_episode_steps)


def _train(resolved: Resolved, outputs: Outputs, truth: Optimum | None) -> None:
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
