"""``qtab.train``: trains one agent."""

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
from qtab.training.callbacks import Callback, EpisodeReader
from qtab.training.resolve import log_default_limit, resolve
from qtab.training.resolved_run import ResolvedRun
from qtab.training.restore import restore, state_of

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
    resolved: ResolvedRun,
    callback: Callback | None = None,
    callback_every: int = CALLBACK_EVERY,
    record: int = 0,
    progress: bool | None = None,
    earlier: Run | None = None,
) -> Run:
    """Trains a run that is already resolved, or continues an earlier one; see :func:`train` and :func:`resume`."""
    total = resolved.config.episodes
    began = time.perf_counter()
    trainer = _core.Trainer(resolved.spec(), resolved.seed, record)
    done = 0
    if earlier is not None:
        restore(trainer, resolved, earlier)
        done, began = len(earlier.episode_returns), began - earlier.seconds
    reader = EpisodeReader(trainer, total)
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
    generators = generator_states(resolved.config, [start for start, _ in kept])
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
        state=state_of(trainer, resolved),
    )
