"""The equations of an update of action values, and the eligibility traces that it applies."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import required
from qtab.config import Config
from qtab.explanation.equations import (
    bootstrap_symbol,
    differential_equations,
    target_equation,
    true_online_equation,
    update_equation,
)
from qtab.explanation.records import Trace, Update


def equations_of(config: Config, update: Update) -> list[tuple[str, str]]:
    """Returns the equations of an update and their numbers; ``update`` has neither yet."""
    name = f"Q{update.table + 1}(S, A)" if config.algorithm == "double_q_learning" else "Q(S, A)"
    symbol = bootstrap_symbol(config.algorithm, update.table)
    target, before, rewards, bootstrap = update.target, update.before, update.rewards, update.bootstrap
    if update.average_reward is not None and bootstrap is not None:
        average, step_size = update.average_reward, required("reward_learning_rate", config.reward_learning_rate)
        lines = differential_equations(symbol, rewards[0], average, bootstrap, target, before, step_size)
    else:
        name_of_reward = "(R + κ √τ)" if config.algorithm == "dyna_q_plus" and update.step is None else "R"
        lines = [target_equation(symbol, rewards, config.discount, bootstrap, target, name_of_reward)]
    sizes = update.rows, update.step_sizes, update.traces
    if update.old_value is None:
        return [*lines, update_equation(name, before, target, update.after, *sizes)]
    return [*lines, true_online_equation(name, before, target, update.after, update.old_value, *sizes)]


SHOWN_TRACES = 8
"""The number of traces of a step that are kept, the largest ones."""

Table = NDArray[np.float64]


def largest_traces(
    z: Table,
    values: Table,
    cell: Callable[[int], tuple[int, ...] | None],
) -> tuple[tuple[Trace, ...], int]:
    """Returns the largest traces before an update, whose ``after`` is NaN, and the number of all nonzero traces.

    Args:
        z: (rows, actions): the traces.
        values: (rows, actions): the values before the update.
        cell: Returns the cell of a row.
    """
    traced = np.argwhere(z != 0.0)
    order = np.argsort(-np.abs(z[z != 0.0]), kind="stable")[:SHOWN_TRACES]
    found = tuple(
        Trace(row, cell(row), action, float(z[row, action]), float(values[row, action]), float("nan"))
        for row, action in traced[order].tolist()
    )
    return found, len(traced)


def changed(traces: tuple[Trace, ...], values: Table) -> tuple[Trace, ...]:
    """Returns the traces with the values after the update."""
    return tuple(replace(trace, after=float(values[trace.row, trace.action])) for trace in traces)
