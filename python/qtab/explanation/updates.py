"""An update from its beginning to its end."""

from dataclasses import dataclass

from qtab._utils.checks import required
from qtab.config import Config
from qtab.explanation.equations import (
    bootstrap_symbol,
    differential_equations,
    target_equation,
    true_online_equation,
    update_equation,
)
from qtab.explanation.records import Update

ActionValues = tuple[tuple[float, ...], ...]
"""(n_active, actions): the rows of a state."""


@dataclass
class UnfinishedUpdate:
    """An update before the values change."""

    step: int | None
    table: int
    rows: tuple[int, ...]
    action: int
    rewards: tuple[float, ...]
    bootstrap: float | None
    target: float
    weights: ActionValues
    step_sizes: tuple[float, ...] = ()
    traces: tuple[float, ...] = ()
    old_value: float | None = None
    average_reward: float | None = None


def finish_update(
    unfinished: UnfinishedUpdate, config: Config, cell: tuple[int, ...] | None, weights: ActionValues
) -> Update:
    """Returns an update whose values have changed to ``weights``."""
    weights_before = tuple(row[unfinished.action] for row in unfinished.weights)
    weights_after = tuple(row[unfinished.action] for row in weights)
    before, after = total(weights_before), total(weights_after)
    name = f"Q{unfinished.table + 1}(S, A)" if config.algorithm == "double_q_learning" else "Q(S, A)"
    lines = []
    if unfinished.average_reward is not None and unfinished.bootstrap is not None:
        reward, average, following = unfinished.rewards[0], unfinished.average_reward, unfinished.bootstrap
        symbol, step_size = (
            bootstrap_symbol(config.algorithm, 0),
            required("reward_learning_rate", config.reward_learning_rate),
        )
        lines += differential_equations(symbol, reward, average, following, unfinished.target, before, step_size)
    elif unfinished.step is not None:
        symbol = bootstrap_symbol(config.algorithm, unfinished.table)
        lines.append(
            target_equation(symbol, unfinished.rewards, config.discount, unfinished.bootstrap, unfinished.target)
        )
    sizes = unfinished.rows, unfinished.step_sizes, unfinished.traces
    if unfinished.old_value is None:
        lines.append(update_equation(name, before, unfinished.target, after, *sizes))
    else:
        lines.append(true_online_equation(name, before, unfinished.target, after, unfinished.old_value, *sizes))
    return Update(
        step=unfinished.step,
        table=unfinished.table,
        rows=unfinished.rows,
        cell=cell,
        action=unfinished.action,
        rewards=unfinished.rewards,
        bootstrap=unfinished.bootstrap,
        target=unfinished.target,
        error=unfinished.target - before,
        step_sizes=unfinished.step_sizes,
        traces=unfinished.traces,
        old_value=unfinished.old_value,
        average_reward=unfinished.average_reward,
        before=before,
        after=after,
        weights_before=weights_before,
        weights_after=weights_after,
        equations=tuple(symbols for symbols, _ in lines),
        numbers=tuple(numbers for _, numbers in lines),
    )


def total(weights: tuple[float, ...]) -> float:
    """Returns a value: the sum of its weights, from left to right."""
    value, *others = weights
    for weight in others:
        value += weight
    return value
