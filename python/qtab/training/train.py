"""``qtab.train``: from an environment and a config to a run."""

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
from qtab.config import Config
from qtab.rendering.replay import starts
from qtab.results.run import Recording, Run
from qtab.training.callbacks import Callback, Finished
from qtab.training.resolve import Resolved, log_default_limit, resolve

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
    resolved: Resolved,
    callback: Callback | None,
    callback_every: int,
    record: int = 0,
    progress: bool | None = None,
) -> Run:
    """Trains what was resolved before; see :func:`train`."""
    total = resolved.config.episodes
    began = time.perf_counter()
    trainer = _core.Trainer(resolved.spec(), resolved.seed, record)
    finished = Finished(trainer, total)
    done = 0
    try:
        with ProgressBar(total, "episode", progress) as shown:
            while done < total:
                target = min(done + callback_every, total) if callback is not None else total
                for stop in shown.chunks(done, target):
                    trainer.advance(stop)
                done = target
                if callback is not None:
                    verdict = callback(finished.look())
                    if verdict is not None and not verdict:  # NumPy's False stops too
                        break
        _refuse_overflow(trainer, resolved.config)
    except BaseException as error:
        run = _run(resolved, trainer, began)
        with suppress(AttributeError):  # an exception that takes nothing along still comes through
            error.run = run  # type: ignore[attr-defined]
        raise
    return _run(resolved, trainer, began)


def _refuse_overflow(trainer: _core.Trainer, config: Config) -> None:
    """The learners notice values that they compute with; here those that were never read again."""
    missing = isinstance(config.initial_q, np.ndarray) and np.isneginf(config.initial_q.ravel())
    if not (np.isfinite(trainer.tables()) | missing).all():
        episode = len(trainer.episodes()[0]) - 1
        raise OverflowError(
            f"the action values overflowed by episode {episode} (counted from 0); most likely the rewards or initial_q "
            "are too large"
        )


def _run(resolved: Resolved, trainer: _core.Trainer, began: float) -> Run:
    returns, lengths, terminated = trainer.episodes()
    kept: list[tuple[Any, list[int]]] = trainer.recordings()
    first = len(returns) - len(kept)
    generators = starts(resolved.config, [start for start, _ in kept])
    recordings = tuple(
        Recording(first + index, generator, tuple(resolved.grid.choices[action] for action in actions))
        for index, (generator, (_, actions)) in enumerate(zip(generators, kept, strict=True))
    )
    return Run(
        config=resolved.config,
        tables=trainer.tables().reshape(-1, resolved.grid.rows, resolved.grid.actions),
        episode_returns=returns,
        episode_lengths=lengths,
        terminated=terminated,
        grid=resolved.grid,
        completed=len(returns) == resolved.config.episodes,
        seconds=time.perf_counter() - began,
        versions=versions(),
        recordings=recordings,
    )
