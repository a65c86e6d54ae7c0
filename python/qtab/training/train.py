"""``qtab.train``: trains one agent."""

import time
from contextlib import suppress
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec

from qtab import _core
from qtab._utils import checks
from qtab._utils.progress import ProgressBar
from qtab._utils.versions import versions
from qtab.rendering.replay import starts
from qtab.results.run import Recording, Run
from qtab.training.callbacks import Callback, EpisodeReader
from qtab.training.resolve import log_default_limit, resolve
from qtab.training.resolved_run import ResolvedRun

CALLBACK_EVERY = 100


def train(
    env: str | EnvSpec | gym.Env,
    *,
    callback: Callback | None = None,
    callback_every: int = CALLBACK_EVERY,
    record: int = 0,
    progress: bool | None = None,
    **overrides: Any,
) -> Run:
    """Trains a tabular agent; the same seed gives the table that Gymnasium and NumPy would have given, bit for bit.

    Args:
        env: An environment's id, its EnvSpec, or an environment (which is stepped as it stands, and not closed).
        callback: Called every ``callback_every`` episodes, and after the last; returning False stops the run.
        callback_every: How many episodes lie between two calls.
        record: How many of the last episodes to keep for playing again (``run.recordings``).
        progress: Whether to show a progress bar; None shows one on a terminal, to runs of more than a second.
        **overrides: The fields of :class:`qtab.Config`, ``algorithm=``, ``discretizer=`` and ``preset=`` among them;
            ``qtab train --help`` says what each means. An explicit one wins over the preset, the preset over the
            default.

    Returns:
        The run. ``run.completed`` is False where a callback stopped it.

    Raises:
        gymnasium.error.Error: Gymnasium's own, for an id that it does not know.
        TypeError: for an argument of the wrong type, or an unknown one.
        ValueError: for an argument out of range, or spaces that do not fit.
        OverflowError: if the values diverge; it names the episode and the likely cause.
        KeyboardInterrupt: on Ctrl-C. It, and whatever the environment or the callback raises, carries the run so far
            as ``.run``.
    """
    callback_every = checks.integer("callback_every", callback_every, least=1)
    if callback is not None and not callable(callback):
        raise TypeError(f"callback must be callable, got {callback!r}")
    record = checks.count("record", record, least=0)
    resolved = resolve(env, overrides)
    log_default_limit(resolved)
    try:
        return train_resolved(resolved, callback, callback_every, record, progress)
    finally:
        resolved.close()


def train_resolved(
    resolved: ResolvedRun,
    callback: Callback | None = None,
    callback_every: int = CALLBACK_EVERY,
    record: int = 0,
    progress: bool | None = None,
) -> Run:
    """Trains a run that is already resolved; see :func:`train`."""
    total = resolved.config.episodes
    began = time.perf_counter()
    trainer = _core.Trainer(resolved.spec(), resolved.seed, record)
    reader = EpisodeReader(trainer, total)
    done = 0
    try:
        with ProgressBar(total, "episode", progress) as bar:
            while done < total:
                target = min(done + callback_every, total) if callback is not None else total
                for until in bar.chunks(done, target):
                    trainer.advance(until)
                done = target
                if callback is not None:
                    proceed = callback(reader.read())
                    if proceed is not None and not proceed:  # NumPy's False stops, too
                        break
    except BaseException as error:
        _attach(error, _run(resolved, trainer, began))
        raise
    run = _run(resolved, trainer, began)
    overflow = _overflow(run)
    if overflow is not None:
        _attach(overflow, run)
        raise overflow
    return run


def _attach(error: BaseException, run: Run) -> None:
    with suppress(AttributeError):  # some exceptions take no attributes
        error.run = run  # type: ignore[attr-defined]


def _overflow(run: Run) -> OverflowError | None:
    """The learners notice an overflow in the values that they read; here it is in values that were not read again."""
    initial_q = run.config.initial_q
    missing = np.isneginf(initial_q.ravel()) if isinstance(initial_q, np.ndarray) else np.False_
    if (np.isfinite(run.tables.ravel()) | missing).all():
        return None
    episode = len(run.episode_returns) - 1
    return OverflowError(
        f"the action values overflowed by episode {episode} (counted from 0); most likely the rewards or initial_q "
        "are too large"
    )


def _run(resolved: ResolvedRun, trainer: _core.Trainer, began: float) -> Run:
    returns, lengths, terminated = trainer.episodes()
    kept: list[tuple[Any, list[int]]] = trainer.recordings()
    first = len(returns) - len(kept)
    generators = starts(resolved.config, [start for start, _ in kept])
    recordings = tuple(
        Recording(first + index, generator, tuple(resolved.actions[column] for column in columns))
        for index, (generator, (_, columns)) in enumerate(zip(generators, kept, strict=True))
    )
    return Run(
        config=resolved.config,
        tables=trainer.tables().reshape(-1, resolved.discretizer.n_rows, len(resolved.actions)),
        episode_returns=returns,
        episode_lengths=lengths,
        terminated=terminated,
        discretizer=resolved.discretizer,
        actions=resolved.actions,
        completed=len(returns) == resolved.config.episodes,
        seconds=time.perf_counter() - began,
        versions=versions(),
        recordings=recordings,
    )
