"""Restores a trainer, and an environment stepped in Python, to the point where an earlier run stopped."""

import logging
from typing import Any

import gymnasium as gym
import numpy as np

from qtab import _core
from qtab._utils.checks import required
from qtab.results.run import Run
from qtab.results.run_state import RunState, generator_state
from qtab.training.setup.environment import PythonEnvironment
from qtab.training.setup.resolved_run import ResolvedRun

_LOGGER = logging.getLogger("qtab")


def restore(trainer: _core.Trainer, resolved: ResolvedRun, earlier: Run) -> None:
    """Restores the trainer of an earlier run, and logs if the episode in which the run stopped is lost.

    Raises:
        ValueError: if the state of the earlier run does not fit.
    """
    state = required("run.state", earlier.state)
    if isinstance(resolved.environment, PythonEnvironment):
        _restore_generator(resolved.environment.env, resolved.seed, state)
        continue_after(resolved.environment.env, int(earlier.episode_lengths.sum()))
    elif state.generator is not None:
        raise ValueError("run must be resumed with env=, an environment stepped in Python as the run was trained on")
    tables = [table.ravel() for table in earlier.tables]
    episodes = earlier.episode_returns, earlier.episode_lengths, earlier.terminated
    try:
        is_lost = trainer.restore(state.checkpoint, tables, episodes)
    except ValueError as error:
        raise ValueError(
            f"run must have an undamaged state from this version of qtab: {error}; "
            "qtab.train(..., initial_q=run.q_table) continues to learn from its table"
        ) from None
    if is_lost:
        _LOGGER.warning(
            "the run was stopped within episode %s (counted from 0), which cannot be continued: a new episode begins, "
            "and from there on the results differ from those of an uninterrupted run",
            f"{len(earlier.episode_returns):,}",
        )


def continue_after(env: gym.Env, steps: int) -> None:
    """Passes the number of steps taken to ``resume_after``, a method of environments that change with time."""
    resume_after = getattr(env.unwrapped, "resume_after", None)
    if callable(resume_after):
        resume_after(steps)


def _restore_generator(env: gym.Env, seed: int, state: RunState) -> None:
    if state.generator is None:
        raise ValueError("run was trained in Rust, and can be resumed only by its environment's id")
    env.reset(seed=seed)
    try:
        env.unwrapped.np_random.bit_generator.state = _with_arrays(state.generator)
    except (TypeError, ValueError, KeyError, OverflowError) as error:
        raise ValueError(f"run has a generator that its environment cannot take over: {error}") from None


def _with_arrays(state: Any) -> Any:
    """Converts JSON lists into the arrays that some bit generators need."""
    if isinstance(state, dict):
        return {name: _with_arrays(value) for name, value in state.items()}
    return np.array(state, np.uint64) if isinstance(state, list) else state


def state_of(trainer: _core.Trainer, resolved: ResolvedRun, snapshots: tuple[int, ...]) -> RunState | None:
    """Returns the state for :func:`restore`. If that fails, logs a warning and returns None, so the run is not lost.

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
