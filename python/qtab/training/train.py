"""``qtab.train``: trains one agent."""

import logging
import os
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec
from typing_extensions import Unpack

from qtab import _core
from qtab._utils.attach import attach, is_raised_in
from qtab._utils.progress import ProgressBar
from qtab._utils.versions import versions
from qtab.config import Config
from qtab.config.help import with_settings
from qtab.config.merge import collect
from qtab.config.settings import Settings
from qtab.results.recording import SnapshotCollector, recordings_of, snapshot_episodes
from qtab.results.run import Run
from qtab.results.run_state import RunState, generator_state
from qtab.training.callbacks import CALLBACK_EVERY, CallbackList, Callbacks, TrainingOptions
from qtab.training.setup.environment import PythonEnvironment
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import ResolvedRun, log_default_limit, log_python_stepping, masks_of
from qtab.training.setup.run_memory import check_run_memory, tables_shape

_LOGGER = logging.getLogger("qtab")


@with_settings
def train(
    env: str | EnvSpec | gym.Env | None = None,
    *,
    config: Config | Mapping[str, Any] | None = None,
    resume: "Run | str | os.PathLike[str] | None" = None,
    callback: Callbacks | None = None,
    callback_every: int = CALLBACK_EVERY,
    record: int = 0,
    visits: bool = False,
    snapshots: int | Sequence[int] | None = None,
    progress: bool | None = None,
    memory_limit: int | None = None,
    **settings: Unpack[Settings],
) -> Run:
    """Trains a tabular agent. The same seed gives the table that Gymnasium and NumPy would give, bit for bit.

    A setting comes from the first of these that has it: a keyword, ``config``, the preset named by ``preset``, the
    environment's first preset, the default.

    Args:
        env: An environment's id, its EnvSpec, or an environment, which is not closed. None takes the environment of
            ``config``. If Rust implements an environment and it is unchanged since ``gymnasium.make``, Rust trains
            with the same numbers and leaves the object untouched. Any other environment is stepped in Python; the
            logger ``qtab`` gives the reason once, unless ``progress`` is False.
        config: The settings to start from. ``qtab.train(config=run.config)`` repeats a run exactly, in the environment
            that it was trained on, with its wrappers. Settings of a Config that do not apply together with the
            keywords are ignored, as are learning rates and ``initial_q`` where a new discretizer gives them another
            scale; with another environment, so are its ``env_kwargs``, its ``preset`` and settings derived from its
            own environment, such as the time limit. A mapping gives only some settings, as keywords do.
        resume: A run that was stopped early, or the path of its file, to continue exactly where it stopped; see
            :func:`qtab.resume`. Its settings apply: any given here must be the same, except for ``episodes``. Visits
            and snapshots are continued if the run has them. A run that has all its episodes is returned unchanged,
            and a message is logged.
        callback: A callable, or a sequence of them, called with a :class:`qtab.Progress` every ``callback_every``
            episodes and after the last one. Any of them stops the run by returning False. The callbacks of
            :mod:`qtab.callbacks` save, log, evaluate and draw.
        callback_every: The number of episodes between two calls, for callbacks without their own interval.
        record: The number of last episodes to keep for replay, in ``run.recordings``.
        visits: Whether to count how often each action was taken in each cell, in ``run.visits``.
        snapshots: The number of copies of the tables to keep in ``run.snapshots``, evenly spaced over the episodes and
            including the last one; or the episodes after which to copy them, such as ``(0, 10, 100)``, where 0 is
            before the first.
        progress: Whether to show a progress bar. None shows one on a terminal or in a notebook if the run takes more
            than a second.
        memory_limit: The number of bytes that the run may take; None means half of the machine's memory, but no
            more than is free.
        **settings: The settings of the run, explained below.

    Returns:
        The run. ``run.completed`` is False if a callback stopped it.

    Raises:
        gymnasium.error.Error: raised by Gymnasium for an unknown environment id.
        MemoryError: before the first episode, if the run would take more than ``memory_limit``; during the run, if its
            recordings, or the episode or model that its algorithm stores, exceed the limit or the machine's memory.
        TypeError: for an argument of the wrong type, or an unknown one.
        ValueError: for an argument out of range, spaces that do not fit, or a run that cannot be resumed.
        OverflowError: if the values diverge; the message names the episode and the likely cause.
        KeyboardInterrupt: on Ctrl-C. Like any exception raised by the environment or the callback, it carries the run
            so far as ``.run``.
    """
    options = TrainingOptions(callback, callback_every, record, visits, snapshots, progress, memory_limit)
    env, base = collect(train, env, config, settings)
    earlier = None
    if isinstance(base, Config):
        from qtab.training.setup.run_env import base_for, resolve_over

        base = base_for(env, config, base)
    if resume is not None:
        from qtab.training.earlier_run import resolve_resumed

        earlier, options, again = resolve_resumed(resume, env, base, settings, options)
        if again is None:
            return earlier
        resolved = again
    elif isinstance(base, Config):
        resolved, _, _ = resolve_over(env, base, settings, resolve)
    else:
        resolved = resolve(env, base, settings)
    log_default_limit(resolved)
    if progress is not False:
        log_python_stepping(resolved)
    try:
        return train_resolved(resolved, options, earlier)
    finally:
        resolved.close()


def train_resolved(resolved: ResolvedRun, options: TrainingOptions | None = None, earlier: Run | None = None) -> Run:
    """Trains a run that is already resolved, or continues an earlier one; see :func:`train` and :func:`qtab.resume`."""
    options = TrainingOptions() if options is None else options
    if options.visits and resolved.discretizer.is_weighted:
        raise ValueError(
            f"visits must be False for discretizer {resolved.config.discretizer!r}, whose states cannot be counted, "
            f"got {options.visits!r}"
        )
    total, record = resolved.config.episodes, int(options.record)
    done, seconds, taken = 0, 0.0, None
    if earlier is None:
        copied_at = snapshot_episodes(options.snapshots, total)
    else:
        from qtab.training.earlier_run import snapshots_of
        from qtab.training.restore import restore

        done, seconds, taken = len(earlier.episode_returns), earlier.seconds, earlier.snapshots
        copied_at = snapshots_of(options, total, earlier)
    memory = check_run_memory(resolved, options, len(copied_at), earlier)
    began = time.perf_counter() - seconds
    trainer = _core.Trainer(resolved.spec(), resolved.seed, record, memory, bool(options.visits))
    collector = SnapshotCollector(trainer, copied_at, tables_shape(resolved, 1)[1:], taken)
    if earlier is not None:
        restore(trainer, resolved, earlier)
    callbacks = CallbackList(options.callback, int(options.callback_every))
    so_far = partial(_run, resolved, trainer, began, collector)
    try:
        with (
            resolved.environment.exclusively(),
            callbacks.start(trainer, resolved, began, partial(so_far, over=False), earlier),
            ProgressBar(total, "episode", options.progress, done=done) as bar,
        ):
            while done < total:
                target = callbacks.next_call(done, total)
                for stop in collector.stops(done, target):
                    for until in bar.chunks(done, stop):
                        trainer.advance(until)
                    done = stop
                if not callbacks.call():
                    break
        trainer.check_tables()
    except BaseException as error:
        if isinstance(error, ValueError) and error.args and is_raised_in(error, train_resolved):
            # Raised by the extension for an observation; errors of an environment or a callback pass unchanged.
            error.args = (resolved.discretizer.in_terms_of_space(str(error)), *error.args[1:])
        with suppress(MemoryError):  # if the copies do not fit either, raise the error without them
            attach(error, run=so_far())
        raise
    return so_far()


def _run(
    resolved: ResolvedRun,
    trainer: _core.Trainer,
    began: float,
    collector: SnapshotCollector,
    *,
    over: bool = True,
) -> Run:
    """Returns the run of a trainer. A run that is not ``over`` continues afterwards, and has no recordings yet."""
    tables = trainer.tables()
    returns, lengths, terminated = trainer.take_episodes() if over else trainer.episodes()
    kept = trainer.take_recordings() if over else []
    visits = trainer.visits()
    return Run(
        config=resolved.config,
        tables=tables.reshape(tables_shape(resolved, 1)[1:]),
        episode_returns=returns,
        episode_lengths=lengths,
        terminated=terminated,
        discretizer=resolved.discretizer.as_learned(),
        actions=resolved.actions,
        completed=len(returns) == resolved.config.episodes,
        seconds=time.perf_counter() - began,
        versions=versions(),
        recordings=recordings_of(resolved.config, resolved.actions, kept, len(returns)) if kept else (),
        visits=None if visits is None else visits.reshape(*resolved.discretizer.shape, len(resolved.actions)),
        snapshots=collector.snapshots(),
        action_masks=masks_of(trainer, resolved),
        average_reward=trainer.average_reward(),
        state=_state(trainer, resolved, collector.to_take),
    )


def _state(trainer: _core.Trainer, resolved: ResolvedRun, snapshots: tuple[int, ...]) -> RunState | None:
    """Returns the state for :func:`qtab.resume`. If that fails, logs a warning and returns None: the run is not lost.

    Args:
        trainer: The trainer.
        resolved: The run of the trainer.
        snapshots: The episodes at which snapshots are still to be taken.
    """
    environment = resolved.environment
    generator = None
    try:
        if isinstance(environment, PythonEnvironment):
            generator = generator_state(environment.env.unwrapped.np_random)
        return RunState(trainer.checkpoint(), generator, snapshots, resolved.extensions)
    except Exception as error:  # such as an environment that fails
        _LOGGER.warning("the run cannot be resumed: its state could not be read (%s: %s)", type(error).__name__, error)
        return None
