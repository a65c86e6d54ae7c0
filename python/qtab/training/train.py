"""``qtab.train``: from an environment and a config to a run."""

import time
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from typing_extensions import Unpack

from qtab import _core
from qtab._utils import checks
from qtab._utils.progress import ProgressBar
from qtab._utils.versions import versions
from qtab.config import Config
from qtab.config.layers import collect, over
from qtab.config.settings import Settings
from qtab.config.signature import with_settings
from qtab.rendering.replay import generator_states
from qtab.results.run import Recording, Run
from qtab.training.callbacks import Callback, Finished
from qtab.training.resolve import Resolved, log_default_limit, resolve

CALLBACK_EVERY = 100


@with_settings
def train(
    env: str | EnvSpec | gym.Env | None = None,
    *,
    config: Config | Mapping[str, Any] | None = None,
    callback: Callback | None = None,
    callback_every: int = CALLBACK_EVERY,
    record: int = 0,
    progress: bool | None = None,
    **settings: Unpack[Settings],
) -> Run:
    """Trains a tabular agent. The same seed gives the table that Gymnasium and NumPy would give, bit for bit.

    A setting comes from the first of these that has it: a keyword, ``config``, the preset named by ``preset``, the
    environment's first preset, the default.

    Args:
        env: An environment's id, its EnvSpec, or an environment, which is used as it is and not closed. None takes the
            environment of ``config``.
        config: The settings to start from: the config of a run, ``qtab.train(config=run.config)``, repeats the run
            exactly. Of a Config, the settings that do not apply beside the keywords are ignored, and with another
            environment its ``env_kwargs`` and ``preset`` as well. A mapping gives only some settings, as keywords do.
        callback: Called with a :class:`qtab.Progress` after every ``callback_every`` episodes and after the last one.
            It stops the run by returning False.
        callback_every: The number of episodes between two calls.
        record: The number of last episodes to keep for replay, in ``run.recordings``.
        progress: Whether to show a progress bar. None shows one on a terminal if the run takes more than a second.
        **settings: The settings of the run, explained below.

    Returns:
        The run. ``run.completed`` is False if a callback stopped it.

    Raises:
        gymnasium.error.Error: raised by Gymnasium for an unknown environment id.
        TypeError: for an argument of the wrong type, or an unknown one.
        ValueError: for an argument out of range, or spaces that do not fit.
        OverflowError: if the values diverge; it names the episode and the likely cause.
        KeyboardInterrupt: on Ctrl-C. Like any exception raised by the environment or the callback, it carries the run
            so far as ``.run``.
    """
    callback_every = checks.integer("callback_every", callback_every, least=1)
    if callback is not None and not callable(callback):
        raise TypeError(f"callback must be callable, got {callback!r}")
    record = checks.count("record", record, least=0)
    env, base = collect(train, env, config, settings)
    resolved = resolve(env, over(base, settings))
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
    generators = generator_states(resolved.config, [start for start, _ in kept])
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
