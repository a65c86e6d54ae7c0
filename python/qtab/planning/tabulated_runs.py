"""Runs on an environment, read as runs on the table that ``qtab.tabulate`` made of it."""

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from qtab.config import DEFAULTS
from qtab.config.config import replace_checked
from qtab.config.functions import checked_mask
from qtab.config.options import OPTIONS
from qtab.config.origin import Origin, copied, trained_on
from qtab.discretizers import Discretizer
from qtab.discretizers.identity import Identity
from qtab.discretizers.time_aware import TimeAware
from qtab.envs.origin.describe import describe
from qtab.envs.origin.description import differences
from qtab.envs.registry import bare_id
from qtab.envs.tabulation.tabulated_env import TabulatedEnv
from qtab.results.action_values import weighted_sum
from qtab.results.run import Run
from qtab.results.runs import Runs

AnyRun = TypeVar("AnyRun", bound=Run | Runs)

_OF_DISCRETIZER = [name for name, option in OPTIONS.items() if option.choice == "discretizer"]
"""The settings that apply to some discretizers only."""


def on_table(run: AnyRun, table: TabulatedEnv) -> AnyRun:
    """Returns a run, or runs, with the values of the states of a table, by the observation of each state.

    Two states that share an observation have the same values. A run on any other environment than the one that was
    tabulated is returned unchanged, as is one on the table.

    Args:
        run: The run on the environment that was tabulated.
        table: The table.

    Raises:
        ValueError: if the environment of the run has the same name, but other arguments, attributes or spaces, or the
            run takes actions that are unavailable in the table.
    """
    made_of, config = table.made_of, run.config
    if made_of is None or bare_id(config.env) != bare_id(made_of.name):
        return run
    description = trained_on(config)
    found = [] if description is None else differences(made_of, description)
    if found:
        raise ValueError(f"run must be on the environment that the table was made of, got another one: {found[0]}")
    cells: Discretizer = Identity.of_space(table.observation_space, len(run.actions))
    rows = np.array([run.discretizer.active_features(observation) for observation in table.observations])
    changes: dict[str, Any] = {"tables": None if run.tables is None else _of_states(run, run.tables, rows)}
    masks = _masks(run, table, rows)
    if config.action_mask is False and _leaves_out_actions(table):
        raise ValueError("run must have action_mask=True, as the table leaves out unavailable actions, got False")
    if isinstance(run.discretizer, TimeAware):
        cells = TimeAware(cells.low, cells.high, cells, run.discretizer.max_episode_steps)
    if masks is not None:
        runs = () if isinstance(run, Run) else (len(run),)
        changes["action_masks"] = masks.reshape(*runs, *cells.shape, len(run.actions))
    if isinstance(run, Run):
        changes |= {"visits": None, "snapshots": None, "recordings": (), "state": None}
    settings = {name: DEFAULTS[name] for name in _OF_DISCRETIZER}
    settings |= {"env": type(table).__name__, "env_kwargs": {}, "discretizer": "identity", "max_rows": None}
    settings |= {"initial_q": _initial(run, rows), "action_mask": masks is not None}
    config = copied(replace_checked(config, **settings), Origin(describe(table)))
    return replace(run, config=config, discretizer=cells, actions=run.actions, **changes)


def _of_states(run: Run | Runs, tables: NDArray[np.float64], rows: NDArray[Any]) -> NDArray[np.float64]:
    """Returns (..., k, states, actions): the values of the states, added in the order in which a run adds them."""
    if run.discretizer.is_weighted:
        values = [weighted_sum(rows, table) for table in tables.reshape(-1, *tables.shape[-2:])]
        return np.reshape(values, (*tables.shape[:-2], len(rows), tables.shape[-1]))
    if isinstance(run.discretizer, TimeAware):
        # (..., steps, cells, actions): each step has a table of its own.
        steps = run.discretizer.max_episode_steps
        parts = tables.reshape(*tables.shape[:-2], steps, -1, tables.shape[-1])
        return parts[..., rows[:, 0], :].reshape(*tables.shape[:-2], -1, tables.shape[-1])
    first, *others = rows.T
    total: NDArray[np.float64] = tables[..., first, :]
    for active in others:
        total = total + tables[..., active, :]
    return total


def _masks(run: Run | Runs, table: TabulatedEnv, rows: NDArray[Any]) -> NDArray[np.bool_] | None:
    """Returns (..., states, actions): the mask of each state; None without masks."""
    function, count = run.config.action_mask, len(run.actions)
    known = None
    if callable(function):
        known = np.ones((len(table.observations), count), np.bool_)
        for state in sorted(_entered(table)):
            known[state] = checked_mask("action_mask", function(table.observations[state]), count)
    elif function and run.action_masks is None and run.tables is not None:
        known = table.masks  # a discretizer without cells, such as tile coding, keeps none
    if known is not None:
        steps = run.discretizer.max_episode_steps if isinstance(run.discretizer, TimeAware) else 1
        repeated = np.tile(known, (steps, 1))
        return repeated if isinstance(run, Run) else np.broadcast_to(repeated, (len(run), *repeated.shape))
    if run.action_masks is None:
        return None
    leading = () if isinstance(run, Run) else (len(run),)
    flat = run.action_masks.reshape(*leading, -1, count)
    if isinstance(run.discretizer, TimeAware):
        parts = flat.reshape(*leading, run.discretizer.max_episode_steps, -1, count)
        return parts[..., rows[:, 0], :].reshape(*leading, -1, count)
    return flat[..., rows[:, 0], :]


def _leaves_out_actions(table: TabulatedEnv) -> bool:
    """Returns whether the table lacks the outcomes of unavailable actions, each of which ends the episode instead."""
    unavailable = [] if table.masks is None else np.argwhere(~table.masks).tolist()
    left_out = (
        len(table.P[state][action]) == 1 and table.P[state][action][0][1::2] == (state, True)
        for state, action in unavailable
    )
    return bool(unavailable) and all(left_out)


def _entered(table: TabulatedEnv) -> set[int]:
    """Returns the states in which an episode begins or goes on; the others are terminal."""
    found = set(np.flatnonzero(table.initial_state_distrib).tolist())
    for actions in table.P.values():
        for outcomes in actions.values():
            found |= {int(state) for probability, state, _, terminated in outcomes if probability and not terminated}
    return found


def _initial(run: Run | Runs, rows: NDArray[Any]) -> Any:
    """Returns the initial value of every state, as far as it is one number; otherwise the setting of the run."""
    initial = run.config.initial_q
    if not isinstance(initial, int | float) or (initial and run.discretizer.is_weighted):
        return (-1.0, 1.0)
    return initial * rows.shape[1]
