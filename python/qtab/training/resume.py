"""``qtab.resume``: continues a run exactly where it stopped."""

import logging
import os
from pathlib import Path
from typing import Any

import gymnasium as gym

from qtab._utils import checks
from qtab._utils.versions import versions
from qtab.config import Config
from qtab.results.run import Run
from qtab.results.storage import load
from qtab.training.callback_list import Callbacks
from qtab.training.options import CALLBACK_EVERY, TrainingOptions
from qtab.training.resolve import resolve
from qtab.training.rows_met import continued
from qtab.training.train import train_resolved

_LOGGER = logging.getLogger("qtab")
_SCHEDULES = {"epsilon_schedule": "epsilon", "learning_rate_schedule": "learning_rate"}


def resume(
    run: "Run | str | os.PathLike[str]",
    episodes: int | None = None,
    env: gym.Env | None = None,
    *,
    callback: Callbacks | None = None,
    callback_every: int = CALLBACK_EVERY,
    record: int = 0,
    progress: bool | None = None,
    memory_limit: int | None = None,
) -> Run:
    """Continues a run that was stopped early, or trains one that has finished for more episodes.

    With the same number of episodes, the result is what the uninterrupted run would have been, bit for bit, even if it
    was stopped in the middle of an episode. With more episodes, what changes over the course of a run, such as a
    falling ε, is spread over all of them, as if the run had had so many from the start: ε continues from another value
    than the one at which it stopped. A message of the logger ``qtab`` then says so.

    An environment that is stepped in Python is resumed with its next episode, since the state within an episode is the
    environment's own. The result is that of the uninterrupted run if it was stopped between two episodes and the
    environment keeps nothing from one episode to the next but its ``np_random``; a message says where it was not.

    Args:
        run: The run, or the path of a file that :meth:`qtab.Run.save` wrote.
        episodes: The number of episodes of the whole run, those that are finished included. None takes that of the run.
        env: The environment, for a run that was trained on an environment without an id. It is not closed.
        callback: As for :func:`qtab.train`; it sees the whole run.
        callback_every: As for :func:`qtab.train`.
        record: As for :func:`qtab.train`.
        progress: As for :func:`qtab.train`.
        memory_limit: As for :func:`qtab.train`.

    Returns:
        The whole run: its first episodes are those of ``run``, which stays as it is. Visits are counted on if they were
        counted; snapshots are those of ``run``.

    Raises:
        OSError: if the file cannot be read.
        TypeError: for an argument of the wrong type.
        ValueError: for a file that is not a run, a run that has finished, or one that cannot be resumed: it says why.
        KeyboardInterrupt: on Ctrl-C. Like any exception raised by the environment or the callback, it carries the run
            so far as ``.run``, which can be resumed again.
    """
    run = run if isinstance(run, Run) else load(_path(run))
    if env is not None and not isinstance(env, gym.Env):
        raise TypeError(f"env must be an environment, got {env!r}")
    visits = run.visits is not None
    options = TrainingOptions(callback, callback_every, record, visits, None, progress, memory_limit)
    config = _config(run, episodes)
    settings = {name: value for name, value in vars(config).items() if name != "env"}
    resolved = continued(resolve(config.env if env is None else env, settings), run)
    try:
        _log_what_differs(run, config)
        return train_resolved(resolved, options, earlier=run)
    finally:
        resolved.close()


def _path(run: Any) -> Path:
    try:
        return Path(run)
    except TypeError:
        raise TypeError(f"run must be a Run or the path of a saved run, got {run!r}") from None


def _config(run: Run, episodes: int | None) -> Config:
    """The config of the whole run."""
    finished = len(run.episode_returns)
    if run.state is None:
        raise ValueError(
            "run must have the state of its training, which runs of train_many and files of earlier versions do not "
            "have; qtab.train(..., initial_q=run.q_table) learns on from its table"
        )
    if episodes is None and finished >= run.config.episodes:
        raise ValueError(f"episodes must be given for a run that has finished: more than its {finished:,}")
    count = run.config.episodes if episodes is None else checks.count("episodes", episodes, least=1)
    if count <= finished:
        raise ValueError(f"episodes must be more than the {finished:,} that the run has finished, got {episodes!r}")
    return run.config if count == run.config.episodes else run.config.replace(episodes=count)


def _log_what_differs(run: Run, config: Config) -> None:
    """Says where the result is not that of an uninterrupted run, or may not be."""
    if config.episodes != run.config.episodes:
        falling = [rate for schedule, rate in _SCHEDULES.items() if getattr(config, schedule) == "linear"]
        if falling:
            _LOGGER.warning(
                "%s now %s linearly over %s episodes instead of %s",
                " and ".join(falling),
                "fall" if len(falling) > 1 else "falls",
                f"{config.episodes:,}",
                f"{run.config.episodes:,}",
            )
    here = versions()
    others = [f"{name} {run.versions.get(name)}" for name in here if run.versions.get(name) != here[name]]
    if others:
        _LOGGER.warning("the run was made with %s: its bits may differ from here on", ", ".join(others))
