"""An update from its beginning to its end."""

from dataclasses import dataclass

from qtab.config import Config
from qtab.explanation.equations import bootstrap_symbol, target_equation, true_online_equation, update_equation
from qtab.explanation.records import Update

ActionValues = tuple[tuple[float, ...], ...]
"""(n_active, actions): the rows of a state."""


@dataclass
class Begun:
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


def finished(begun: Begun, config: Config, cell: tuple[int, ...] | None, weights: ActionValues) -> Update:
    """Returns an update whose values have changed to ``weights``."""
    weights_before = tuple(row[begun.action] for row in begun.weights)
    weights_after = tuple(row[begun.action] for row in weights)
    before, after = total(weights_before), total(weights_after)
    name = f"Q{begun.table + 1}(S, A)" if config.algorithm == "double_q_learning" else "Q(S, A)"
    lines = []
    if begun.step is not None:
        symbol = bootstrap_symbol(config.algorithm, begun.table)
        lines.append(target_equation(symbol, begun.rewards, config.discount, begun.bootstrap, begun.target))
    sizes = begun.rows, begun.step_sizes, begun.traces
    if begun.old_value is None:
        lines.append(update_equation(name, before, begun.target, after, *sizes))
    else:
        lines.append(true_online_equation(name, before, begun.target, after, begun.old_value, *sizes))
    return Update(
        step=begun.step,
        table=begun.table,
        rows=begun.rows,
        cell=cell,
        action=begun.action,
        rewards=begun.rewards,
        bootstrap=begun.bootstrap,
        target=begun.target,
        error=begun.target - before,
        step_sizes=begun.step_sizes,
        traces=begun.traces,
        old_value=begun.old_value,
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
