"""``qtab train``."""

from collections.abc import Callable

import gymnasium as gym
import numpy as np

from qtab._utils.progress import print_above
from qtab.cli.outputs import Outputs, counted, last_episodes
from qtab.cli.settings import with_initial_q
from qtab.cli.train_arguments import flags_of, parse_arguments
from qtab.cli.usage import usage_errors
from qtab.config.presets import presets
from qtab.envs.registry import spec_of
from qtab.planning import Optimum, optimum
from qtab.results.run import Run
from qtab.results.snapshots import snapshot_episodes
from qtab.results.summary import FINAL_EPISODES, SOLVED_EPISODES, best_mean_returns, default_block
from qtab.training.callbacks import Progress
from qtab.training.options import TrainingOptions
from qtab.training.resolve import resolve, time_limit_notice
from qtab.training.resolved_run import NativeEnvironment, ResolvedRun
from qtab.training.train import train_resolved

MAX_QUICK_UPDATES = 10**8
"""The optimum of a table takes less than a second with at most so many updates, and is then always computed."""


def run(arguments: list[str]) -> int:
    """Trains and reports; returns the exit code."""
    asked, env, settings = parse_arguments(arguments)
    flags = flags_of(asked)
    with usage_errors(flags, "env"):
        resolved = resolve(env, with_initial_q(settings))
    try:
        with usage_errors(flags, "env"):
            outputs = Outputs(resolved.config, asked.save, asked.plot, asked.watch, asked.record)
            snapshots = snapshot_episodes(asked.snapshots, resolved.config.episodes)
            best = _optimum(resolved) if asked.optimum or _has_quick_optimum(resolved) else None
        with outputs:
            print_above(_header(resolved))
            _train(resolved, outputs, best, asked.visits, snapshots)
    finally:
        resolved.close()
    return 0


def _header(resolved: ResolvedRun) -> str:
    config = resolved.config
    backend = "in Rust" if config.backend == "rust" else "stepped by Gymnasium in Python"
    parts = [
        f"{config.env} {backend}",
        f"preset {config.preset}" if config.preset is not None else "no preset",
        counted(config.episodes, "episode"),
        f"seed {config.seed}",
    ]
    header = ", ".join(parts)
    return f"{header}\n{time_limit_notice(resolved)}" if resolved.default_time_limit else header


def _has_quick_optimum(resolved: ResolvedRun) -> bool:
    environment = resolved.environment
    if not isinstance(environment, NativeEnvironment) or not environment.entry.has_table:
        return False
    return resolved.discretizer.n_rows * len(resolved.actions) * resolved.max_episode_steps <= MAX_QUICK_UPDATES


def _optimum(resolved: ResolvedRun) -> Optimum:
    config = resolved.config
    return optimum(config.env, env_kwargs=config.env_kwargs, max_episode_steps=config.max_episode_steps)


def _train(
    resolved: ResolvedRun, outputs: Outputs, best: Optimum | None, visits: bool, snapshots: tuple[int, ...]
) -> None:
    block = default_block(resolved.config.episodes)
    averages = _averages(block)
    try:
        finished = train_resolved(
            resolved, TrainingOptions(averages, block, outputs.shown, visits=visits, snapshots=snapshots or None)
        )
    except BaseException as error:
        partial = getattr(error, "run", None)
        if isinstance(partial, Run):
            done, total = len(partial.episode_returns), partial.config.episodes
            averages(Progress(done, total, partial.episode_returns, partial.episode_lengths))
            print_above(f"Stopped after {done:,} of {total:,} episodes; what was learned so far:")
            try:
                _report(partial, outputs, best)
            except ValueError as problem:  # values that overflowed are not saved
                print_above(str(problem))
        raise
    _report(finished, outputs, best)
    outputs.show(finished)


def _report(run: Run, outputs: Outputs, best: Optimum | None) -> None:
    print_above(_summary(run))
    if (verdict := _verdict(run)) is not None:
        print_above(verdict)
    if best is not None:
        gap = str(best.gap(run))
        print_above(gap[0].upper() + gap[1:])
    outputs.keep(run, best)


def _averages(block: int) -> Callable[[Progress], None]:
    """Returns a callback that prints the average return of each block of episodes, as the article does."""
    printed = 0

    def callback(progress: Progress) -> None:
        nonlocal printed
        while printed + block <= progress.episodes:
            average = float(progress.returns[printed : printed + block].mean())
            print_above(f"Episode {printed + block} Average Reward: {round(average, 4)}")
            printed += block  # last, so that a line cut off by Ctrl-C is printed again

    return callback


def _summary(run: Run) -> str:
    returns, steps = run.episode_returns[-FINAL_EPISODES:], int(run.episode_lengths.sum())
    if len(returns) == 0:
        return f"No episode was finished in {run.seconds:.3g} s"
    speed = f" ({steps / run.seconds:,.0f} steps/s)" if run.seconds > 0 else ""
    took = f"{steps:,} steps in {run.seconds:.3g} s{speed}"
    return f"Mean return over {last_episodes(len(returns))}: {returns.mean():.2f}; {took}"


def _verdict(run: Run) -> str | None:
    """Returns whether the run solved its task, and which preset does; None if nothing defines that."""
    try:
        threshold = spec_of(run.config.env).reward_threshold
    except gym.error.Error:
        return None
    if threshold is None or len(run.episode_returns) < SOLVED_EPISODES:
        return None
    best = float(best_mean_returns(run.episode_returns[np.newaxis])[0])
    last = run.episode_returns[-SOLVED_EPISODES:].mean()
    found = f"the best mean return over {SOLVED_EPISODES} consecutive episodes is {best:.2f}"
    if last >= threshold:
        return f"Solved: the last {SOLVED_EPISODES} episodes reach the threshold of {threshold:g}"
    if best >= threshold:
        return f"Solved earlier, not at the end: {found}, the threshold {threshold:g}"
    solving = "solved" in presets(run.config.env) and run.config.preset != "solved"
    return f"Not solved: {found}, the threshold {threshold:g}" + ("; --preset solved reaches it" if solving else "")
