"""Runs with ``time_aware=True`` at one step of the episode, where they have a table like any other run."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.config.config import DEFAULTS, replace_checked
from qtab.config.implied import with_followers
from qtab.results.recording import Snapshots

if TYPE_CHECKING:
    from qtab.results.run import Run
    from qtab.results.runs import Runs

AnyRun = TypeVar("AnyRun", "Run", "Runs")


def checked_step(discretizer: Any, step: Any) -> int:
    """Returns ``step``, after checking it; without ``time_aware``, or a discretizer, it must be 0.

    Raises:
        TypeError: if ``step`` is not an integer.
        ValueError: if ``step`` is negative or not below the time limit.
    """
    if discretizer is None or not discretizer.is_time_aware:
        if checks.integer("step", step, least=0):
            raise ValueError(f"step must be 0 for a run without time_aware=True, got {step!r}")
        return 0
    return checks.integer("step", step, least=0, most=discretizer.max_episode_steps - 1)


def at_step(run: AnyRun, step: Any = 0) -> AnyRun:
    """Returns a run, or runs, with the tables for one step; without ``time_aware`` returns them unchanged.

    Raises:
        TypeError: if ``step`` is not an integer.
        ValueError: if ``step`` is negative or not below the time limit, or not 0 without ``time_aware``.
    """
    discretizer: Any = run.discretizer
    step = checked_step(discretizer, step)
    if not discretizer.is_time_aware:
        return run
    cells, config = discretizer.cells, run.config
    part = slice(step * cells.n_rows, (step + 1) * cells.n_rows)
    initial_q = config.initial_q
    if isinstance(initial_q, np.ndarray):
        rows = initial_q.reshape(-1, discretizer.n_rows, initial_q.shape[-1])[:, part]
        initial_q = rows if len(rows) > 1 else rows.reshape(*cells.shape, -1)
    of_config = {"time_aware": False, "initial_q": initial_q}
    changes: dict[str, Any] = {
        "config": replace_checked(config, **with_followers(config, of_config, DEFAULTS)[0]),
        "discretizer": cells,
        "tables": None if run.tables is None else run.tables[..., part, :],
    }
    if run.action_masks is not None:
        # With many runs, the axis of the runs comes before the axis of the steps.
        axis = run.action_masks.ndim - len(discretizer.shape) - 1
        changes["action_masks"] = np.take(run.action_masks, step, axis=axis)
    own: Any = run  # for attributes of a single run only
    if getattr(own, "visits", None) is not None:
        changes["visits"] = own.visits[step]
    if getattr(own, "snapshots", None) is not None:
        changes["snapshots"] = Snapshots(own.snapshots.episodes, own.snapshots.tables[..., part, :])
    if hasattr(own, "recordings"):
        changes |= {"recordings": (), "state": None}
    return replace(run, **changes)


def over_all_steps(run: Any) -> Any:
    """Returns a run with ``time_aware`` as at the start of an episode, but with its visits at all steps.

    Any other object is returned unchanged.
    """
    visits = getattr(run, "visits", None)
    if visits is None or not run.discretizer.is_time_aware:
        return run
    changed: Any = replace(at_step(run), visits=visits.sum(axis=0))
    return changed


def rows_of(run: "Run", observation: Any, steps: Any) -> Any:
    """Returns the active rows of one or n observations; with ``time_aware``, after ``steps`` steps.

    With weighted features, it returns their values.
    """
    discretizer: Any = run.discretizer
    return (
        discretizer.rows_after(steps, observation)
        if discretizer.is_time_aware
        else discretizer.active_features(observation)
    )


def steps_taken(discretizer: Any, state: Any, episode_start: Any) -> Any:
    """Returns the steps taken, () or (n,), from the state of a policy; 0 without ``time_aware``.

    Raises:
        TypeError: if ``state`` does not hold integers.
        ValueError: if a number is negative, or ``episode_start`` does not have the shape of ``state``.
    """
    if not discretizer.is_time_aware:
        return 0
    given = np.asarray(0 if state is None else state)
    if given.dtype.kind not in "iu":
        raise TypeError(f"state must hold integers, the numbers of steps taken, got {shown(state)}")
    if (given < 0).any():
        raise ValueError(f"state must hold numbers of steps taken, which are not negative, got {shown(state)}")
    starts = np.asarray(episode_start is not None and episode_start, np.bool_)
    if starts.ndim and given.ndim and starts.shape != given.shape:
        raise ValueError(f"episode_start must have the shape {given.shape} of state, got {starts.shape}")
    return np.where(starts, 0, given)


def next_state(discretizer: Any, steps: Any, shape: tuple[int, ...]) -> Any:
    """Returns the steps taken after one more step, an integer or array of ``shape``; None without ``time_aware``."""
    if not discretizer.is_time_aware:
        return None
    following = np.asarray(steps, np.int64) + 1
    return np.array(np.broadcast_to(following, shape)) if shape else int(following.reshape(-1)[0])
