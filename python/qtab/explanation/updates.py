"""The equations of an update of action values, and the eligibility traces that it applies."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import required
from qtab.config import Config
from qtab.explanation.equations import bootstrap_symbol, gain, gain_symbol, number, power, term
from qtab.explanation.records import Trace, Update

SHOWN_REWARDS = 4
"""With more rewards, as in n-step Sarsa, only their discounted sum is shown."""
SHOWN_TRACES = 8
"""The number of traces of a step that are kept, the largest ones."""

Table = NDArray[np.float64]


def equations_of(config: Config, update: Update) -> list[tuple[str, str]]:
    """Returns the equations of an update and their numbers; ``update`` has neither yet."""
    symbol = bootstrap_symbol(config.algorithm, update.table)
    if update.average_reward is not None:
        step_size = required("reward_learning_rate", config.reward_learning_rate)
        lines = _differential(symbol, update, required("bootstrap", update.bootstrap), update.average_reward, step_size)
    else:
        name_of_reward = "(R + κ √τ)" if config.algorithm == "dyna_q_plus" and update.step is None else "R"
        lines = [_target(symbol, update, config.discount, name_of_reward)]
    name = f"Q{update.table + 1}(S, A)" if config.algorithm == "double_q_learning" else "Q(S, A)"
    return [*lines, _update(name, update)]


def _target(symbol: str, update: Update, discount: float, reward_name: str) -> tuple[str, str]:
    """Returns the equation of a target: discounted rewards, and the value of the next state."""
    rewards, symbols, numbers = update.rewards, [], []
    if len(rewards) > SHOWN_REWARDS:
        symbols.append("Σ γ^(k-1) Rk")
        numbers.append(number(math.fsum(reward * discount**index for index, reward in enumerate(rewards))))
    else:
        for index, reward in enumerate(rewards):
            symbols.append(power("γ", index) + (reward_name if len(rewards) == 1 else f"R{index + 1}"))
            numbers.append(power(number(discount), index, " · ") + (term(reward) if index else number(reward)))
    if update.bootstrap is not None:
        symbols.append(power("γ", len(rewards), " ") + symbol)
        numbers.append(power(number(discount), len(rewards), " · ") + term(update.bootstrap))
    if len(numbers) > 1:
        numbers[-1] += f" = {number(update.target)}"
    return f"target = {' + '.join(symbols)}", f"target = {' + '.join(numbers)}"


def _differential(
    symbol: str, update: Update, bootstrap: float, average: float, step_size: float
) -> list[tuple[str, str]]:
    """Returns the equations of a differential target and of the average reward R̄."""
    target, before = number(update.target), term(update.before)
    return [
        (
            f"target = R - R̄ + {symbol}",
            f"target = {number(update.rewards[0])} - {term(average)} + {term(bootstrap)} = {target}",
        ),
        (
            "R̄ <- R̄ + β [target - Q(S, A)]",
            f"R̄ <- {number(average)} + {number(step_size)} · [{target} - {before}]"
            f" = {number(average + step_size * update.error)}",
        ),
    ]


def _update(name: str, update: Update) -> tuple[str, str]:
    """Returns the equation of the new value; with traces z, of true online Sarsa(λ) the dutch traces."""
    before, target, after = number(update.before), number(update.target), number(update.after)
    if update.assigned:
        return f"{name} <- target", f"{name} <- {after}"
    gained = gain_symbol(update.features, traced=bool(update.traces))
    if update.old_value is not None:
        own, old = _gain_numbers(update, ()), term(update.old_value)
        traced = number(gain(update.rows, update.step_sizes, update.traces, update.features))
        return (
            f"{name} <- {name} + {gained} [target - Q_old] - {gain_symbol(update.features)} [{name} - Q_old]",
            f"{name} <- {before} + {traced} · [{target} - {old}] - {own} · [{before} - {old}] = {after}",
        )
    return (
        f"{name} <- {name} + {gained} [target - {name}]",
        f"{name} <- {before} + {_gain_numbers(update, update.traces)} · [{target} - {term(update.before)}] = {after}",
    )


def _gain_numbers(update: Update, traces: Sequence[float]) -> str:
    """Returns the factor of the error: the learning rate, times the number of active rows, times the trace."""
    rows, step_sizes = update.rows, update.step_sizes
    if update.features or len(set(step_sizes)) > 1 or len(set(traces)) > 1 or len(set(rows)) < len(rows):
        return number(gain(rows, step_sizes, traces, update.features))
    shares = f"{len(rows)} · " if len(rows) > 1 else ""
    trace = f" · {term(traces[0])}" if traces else ""
    return f"{shares}{number(step_sizes[0])}{trace}"


def largest_traces(
    z: Table, values: Table, cell: Callable[[int], tuple[int, ...] | None]
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
