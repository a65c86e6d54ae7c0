"""Restores a trainer, and an environment stepped in Python, to the point where an earlier run stopped."""

import logging
from typing import Any

import gymnasium as gym
import numpy as np

from qtab import _core
from qtab._utils.checks import required
from qtab._utils.versions import versions
from qtab.config import Config
from qtab.config.schedules import epsilon
from qtab.results.rates import falling_rates
from qtab.results.run import Run
from qtab.results.run_state import RunState
from qtab.training.setup.environment import PythonEnvironment
from qtab.training.setup.resolved_run import ResolvedRun

_LOGGER = logging.getLogger("qtab")
_PLAYED_AGAIN = ("state of the environment", "position of the environment's generator", "observation of the state")
"""The ends of the errors if an episode of compiled code that is played again is different."""


def restore(trainer: _core.Trainer, resolved: ResolvedRun, earlier: Run) -> None:
    """Restores the trainer of an earlier run.

    It logs if the episode in which the run stopped is lost, and any other reason why the result may differ from that of
    an uninterrupted run.

    Raises:
        ValueError: if the state of the earlier run does not fit.
    """
    _log_what_differs(earlier, resolved.config)
    state, environment = required("run.state", earlier.state), resolved.environment
    if isinstance(environment, PythonEnvironment):
        with environment.exclusively():
            _restore_generator(environment.env, resolved.seed, state)
            continue_after(environment.env, int(earlier.episode_lengths.sum()))
    elif state.generator is not None:
        raise ValueError("run must be resumed with env=, an environment stepped in Python as the run was trained on")
    tables = [table.ravel() for table in earlier.tables]
    episodes = earlier.episode_returns, earlier.episode_lengths, earlier.terminated
    try:
        is_lost = trainer.restore(state.checkpoint, tables, episodes)
    except ValueError as error:
        learn_on = "qtab.train(..., initial_q=run.q_table) continues to learn from its table"
        if earlier.config.backend == "numba" and str(error).endswith(_PLAYED_AGAIN):
            raise ValueError(
                "run must be resumed in the environment as it was: the run was stopped within episode "
                f"{len(earlier.episode_returns):,} (counted from 0), whose steps have other results now. Undo the "
                f"changes of its code and of the values that it uses, or begin a new run: {learn_on}"
            ) from None
        raise ValueError(f"run must have an undamaged state from this version of qtab: {error}; {learn_on}") from None
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


def rising_epsilon(run: Run, config: Config) -> str:
    """Returns the end of a message: how far ε rises when a run is extended, and how to keep it low."""
    schedule, finished = epsilon(config), len(run.episode_returns)
    before, after = schedule.after(finished, run.config.episodes), schedule.after(finished, config.episodes)
    if after <= before or finished == 0:
        return ""
    starts_again = ""
    if config.learning_rate_schedule != "constant":
        starts_again = f" (the learning rate then starts again at {config.learning_rate:.3g})"
    # With the same seed, the new run would repeat the random numbers of the earlier one.
    seed = f", seed={config.seed + 1}" if isinstance(config.seed, int) else ""
    return (
        f": epsilon rises from {before:.3g} to {after:.3g} and falls again, and the returns may become worse at first. "
        f"To keep it low, train on from the table instead{starts_again}: qtab.train(config=run.config.replace("
        f"episodes={config.episodes - finished}, epsilon={config.min_epsilon!r}{seed}, initial_q=run.tables))"
    )


def _log_what_differs(run: Run, config: Config) -> None:
    """Logs why the result differs, or may differ, from that of an uninterrupted run."""
    falling = falling_rates(config)
    if config.episodes != run.config.episodes and falling:
        _LOGGER.warning(
            "%s now %s linearly over %s episodes instead of %s%s",
            " and ".join(falling),
            "fall" if len(falling) > 1 else "falls",
            f"{config.episodes:,}",
            f"{run.config.episodes:,}",
            rising_epsilon(run, config) if "epsilon" in falling else "",
        )
    here = versions()
    others = [f"{name} {run.versions.get(name)}" for name in here if run.versions.get(name) != here[name]]
    if others:
        _LOGGER.warning("the run was made with %s: its bits may differ from here on", ", ".join(others))
