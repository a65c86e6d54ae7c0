"""The equations of an update, in symbols and with their numbers."""

import math
from collections.abc import Sequence

BOOTSTRAP = {
    "q_learning": "max Q(S', a)",
    "sarsa": "Q(S', A')",
    "expected_sarsa": "Σ π(a | S') Q(S', a)",
    "n_step_sarsa": "Q(S', A')",
    "sarsa_lambda": "Q(S', A')",
    "true_online_sarsa_lambda": "Q(S', A')",
    "watkins_q_lambda": "max Q(S', a)",
    "dyna_q": "max Q(S', a)",
    "dyna_q_plus": "max Q(S', a)",
    "prioritized_sweeping": "max Q(S', a)",
    "monte_carlo": "G'",
    "monte_carlo_es": "G'",
    "off_policy_monte_carlo": "G'",
    "differential_sarsa": "Q(S', A')",
    "differential_q_learning": "max Q(S', a)",
    "n_step_tree_backup": "[Σ π(a | S') Q(S', a) + π(A' | S') (G' - Q(S', A'))]",
    "n_step_q_sigma": "[Σ π(a | S') Q(S', a) + (σ ρ + (1 - σ) π(A' | S')) (G' - Q(S', A'))]",
}
"""The value of the next state in the target of each algorithm; Double Q-learning names its tables as well.

G' is the return from the next step on."""
SHOWN_REWARDS = 4
"""With more rewards, as in n-step Sarsa, only their discounted sum is shown."""


def number(value: float) -> str:
    """Returns a number with six digits."""
    return f"{value:.6g}"


def term(value: float) -> str:
    """Returns a number inside an equation: a negative one in parentheses."""
    return f"({number(value)})" if value < 0 else number(value)


def bootstrap_symbol(algorithm: str, table: int) -> str:
    """Returns the value of the next state in the target of an algorithm that updates a table."""
    if algorithm != "double_q_learning":
        return BOOTSTRAP[algorithm]
    learning, other = (1, 2) if table == 0 else (2, 1)
    return f"Q{other}(S', argmax Q{learning}(S', a))"


def target_equation(
    symbol: str, rewards: Sequence[float], discount: float, bootstrap: float | None, target: float, reward_name: str
) -> tuple[str, str]:
    """Returns the equation of a target and its numbers: discounted rewards, and the value of the next state."""
    symbols, numbers = [], []
    if len(rewards) > SHOWN_REWARDS:
        symbols.append("Σ γ^(k-1) Rk")
        numbers.append(number(math.fsum(reward * discount**index for index, reward in enumerate(rewards))))
    else:
        for index, reward in enumerate(rewards):
            symbols.append(power("γ", index) + (reward_name if len(rewards) == 1 else f"R{index + 1}"))
            numbers.append(power(number(discount), index, " · ") + (term(reward) if index else number(reward)))
    if bootstrap is not None:
        symbols.append(power("γ", len(rewards), " ") + symbol)
        numbers.append(power(number(discount), len(rewards), " · ") + term(bootstrap))
    if len(numbers) > 1:
        numbers[-1] += f" = {number(target)}"
    return f"target = {' + '.join(symbols)}", f"target = {' + '.join(numbers)}"


def differential_equations(
    symbol: str, reward: float, average: float, bootstrap: float, target: float, before: float, step_size: float
) -> list[tuple[str, str]]:
    """Returns the equations of a differential target and of the average reward R̄, with their numbers."""
    error = target - before
    return [
        (
            f"target = R - R̄ + {symbol}",
            f"target = {number(reward)} - {term(average)} + {term(bootstrap)} = {number(target)}",
        ),
        (
            "R̄ <- R̄ + β [target - Q(S, A)]",
            f"R̄ <- {number(average)} + {number(step_size)} · [{number(target)} - {term(before)}]"
            f" = {number(average + step_size * error)}",
        ),
    ]


def power(base: str, exponent: int, times: str = " ") -> str:
    """Returns a power as a factor in front of a term; an empty string for an exponent of 0."""
    if exponent == 0:
        return ""
    return f"{base}{times}" if exponent == 1 else f"{base}^{exponent}{times}"


def gain(rows: Sequence[int], step_sizes: Sequence[float], traces: Sequence[float]) -> float:
    """Returns the change of Q(S, A) for an error of 1. With hashing a row can be active several times."""
    if traces:  # a value changes once, however often its row is active
        return sum(size * trace for size, trace in zip(step_sizes, traces, strict=True))
    return sum(rows.count(row) * size for row, size in zip(rows, step_sizes, strict=True))


def gain_numbers(rows: Sequence[int], step_sizes: Sequence[float], traces: Sequence[float]) -> str:
    """Returns the factor of the error: the learning rate, times the number of active rows, times the trace."""
    if len(set(step_sizes)) > 1 or len(set(traces)) > 1 or len(set(rows)) < len(rows):
        return number(gain(rows, step_sizes, traces))
    shares = f"{len(rows)} · " if len(rows) > 1 else ""
    trace = f" · {term(traces[0])}" if traces else ""
    return f"{shares}{number(step_sizes[0])}{trace}"


def update_equation(
    name: str,
    before: float,
    target: float,
    after: float,
    rows: Sequence[int],
    step_sizes: Sequence[float],
    traces: Sequence[float],
) -> tuple[str, str]:
    """Returns the equation of an update and its numbers."""
    if not step_sizes:
        return f"{name} <- target", f"{name} <- {number(after)}"
    factor = gain_numbers(rows, step_sizes, traces)
    return (
        f"{name} <- {name} + α{' z' if traces else ''} [target - {name}]",
        f"{name} <- {number(before)} + {factor} · [{number(target)} - {term(before)}] = {number(after)}",
    )


def true_online_equation(
    name: str,
    before: float,
    target: float,
    after: float,
    old_value: float,
    rows: Sequence[int],
    step_sizes: Sequence[float],
    traces: Sequence[float],
) -> tuple[str, str]:
    """Returns the update of true online Sarsa(λ) and its numbers; z is the dutch trace."""
    own = gain_numbers(rows, step_sizes, ())
    traced = number(gain(rows, step_sizes, traces))
    old = term(old_value)
    return (
        f"{name} <- {name} + α z [target - Q_old] - α [{name} - Q_old]",
        f"{name} <- {number(before)} + {traced} · [{number(target)} - {old}]"
        f" - {own} · [{number(before)} - {old}] = {number(after)}",
    )


def total(weights: tuple[float, ...]) -> float:
    """Returns a value: the sum of its weights, from left to right."""
    value, *others = weights
    for weight in others:
        value += weight
    return value
