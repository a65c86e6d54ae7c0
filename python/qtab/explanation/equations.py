"""The parts of the equations of an update: symbols, and numbers as text."""

from collections.abc import Sequence
from functools import reduce
from operator import add

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


def power(base: str, exponent: int, times: str = " ") -> str:
    """Returns a power as a factor in front of a term; an empty string for an exponent of 0."""
    if exponent == 0:
        return ""
    return f"{base}{times}" if exponent == 1 else f"{base}^{exponent}{times}"


def gain(
    rows: Sequence[int], step_sizes: Sequence[float], traces: Sequence[float], features: Sequence[float] = ()
) -> float:
    """Returns the change of Q(S, A) for an error of 1. With hashing a row can be active several times.

    It is Σ α x², or Σ α z x with traces, if the features x are weighted.
    """
    if features:
        changes = zip(step_sizes, traces or features, features, strict=True)
        return sum(size * trace * x for size, trace, x in changes)
    if traces:  # a value changes once, however often its row is active
        return sum(size * trace for size, trace in zip(step_sizes, traces, strict=True))
    return sum(rows.count(row) * size for row, size in zip(rows, step_sizes, strict=True))


def gain_symbol(features: Sequence[float], *, traced: bool = False) -> str:
    """Returns the symbol of :func:`gain` in front of an error; the number of active rows is left out."""
    if features:
        return "Σ α z x" if traced else "Σ α x²"
    return "α z" if traced else "α"


def total(weights: tuple[float, ...], features: Sequence[float] = ()) -> float:
    """Returns a value: the sum of its weights, from left to right.

    With weighted features it is the sum of w x: every fourth product from left to right, and the four sums in pairs.
    """
    if features:
        products = [weight * x for weight, x in zip(weights, features, strict=True)]
        first, second, third, fourth = (reduce(add, products[part::4], 0.0) for part in range(4))
        return (first + second) + (third + fourth)
    value, *others = weights
    for weight in others:
        value += weight
    return value
