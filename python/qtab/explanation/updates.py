"""Updates in the making: the reported target, the values before, and the finished record."""

from dataclasses import dataclass

from qtab._utils.checks import required
from qtab.config import Config
from qtab.explanation.equations import (
    bootstrap_symbol,
    differential_equations,
    target_equation,
    total,
    true_online_equation,
    update_equation,
)
from qtab.explanation.records import Update

ActionValues = tuple[tuple[float, ...], ...]
"""(n_active, actions): the rows of a state."""


@dataclass(frozen=True)
class Target:
    """The terms of the target of an update, as the learner reports them."""

    step: int | None
    """The step of S and A; None in planning."""
    rewards: tuple[float, ...]
    """The rewards in the target; empty if the target is a return."""
    following: float | None
    """The value of the next state in the target; None if there is none."""


@dataclass
class UnfinishedUpdate:
    """An update before the values change."""

    reported: Target
    table: int
    rows: tuple[int, ...]
    action: int
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
    step, rewards, following = unfinished.reported.step, unfinished.reported.rewards, unfinished.reported.following
    symbol = bootstrap_symbol(config.algorithm, unfinished.table)
    if unfinished.average_reward is not None and following is not None:
        average, step_size = unfinished.average_reward, required("reward_learning_rate", config.reward_learning_rate)
        lines += differential_equations(symbol, rewards[0], average, following, unfinished.target, before, step_size)
    else:
        name_of_reward = "(R + κ √τ)" if config.algorithm == "dyna_q_plus" and step is None else "R"
        lines.append(target_equation(symbol, rewards, config.discount, following, unfinished.target, name_of_reward))
    sizes = unfinished.rows, unfinished.step_sizes, unfinished.traces
    if unfinished.old_value is None:
        lines.append(update_equation(name, before, unfinished.target, after, *sizes))
    else:
        lines.append(true_online_equation(name, before, unfinished.target, after, unfinished.old_value, *sizes))
    return Update(
        step=step,
        table=unfinished.table,
        rows=unfinished.rows,
        cell=cell,
        action=unfinished.action,
        rewards=rewards,
        bootstrap=following,
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
