"""The updates of policy gradient methods, which change preferences and state values."""

from dataclasses import dataclass

from qtab.config import Config
from qtab.explanation.equations import gain, gain_symbol, number, power, term, total

Rows = tuple[tuple[float, ...], ...]

ERROR = {
    "gradient_bandit": "R - R̄",
    "reinforce": "G",
    "reinforce_with_baseline": "δ = G - v(S)",
    "actor_critic": "δ = R + γ v(S') - v(S)",
    "actor_critic_lambda": "δ = R + γ v(S') - v(S)",
}
"""The error of each method in symbols: the target minus the reference."""
SYMBOL = {"gradient_bandit": "(R - R̄)", "reinforce": "G"}
"""The symbol of the error in the update, if it is not δ."""


@dataclass(frozen=True)
class PolicyUpdate:
    """A change of the preferences of S along the gradient of ln π(A | S).

    Its numbers are exact: they give the preferences bit for bit.
    """

    step: int
    """The step of S and A, counted from 0 in the episode."""
    rows: tuple[int, ...]
    """(n_active,): the active rows of S."""
    cell: tuple[int, ...] | None
    """The cell of S; None with tile coding, which has no cells."""
    action: int
    """The column of A."""
    reward: float | None
    """R, if it is in the target; None for REINFORCE, whose target is the return G."""
    bootstrap: float | None
    """v(S') in the target of an actor-critic method; None if the next state is terminal, and for other methods."""
    target: float
    """The reward of a bandit, the return G, or R + γ v(S')."""
    reference: float
    """The value to compare the target with: the average reward R̄ of a bandit, or v(S); 0 without a baseline."""
    error: float
    """The target minus the reference."""
    power: float
    """γ to the power of ``step``; 1 for a bandit."""
    step_size: float
    """α, divided by the number of active rows; with weighted features that of the first one."""
    gradient: tuple[float, ...]
    """(actions,): the gradient of ln π(A | S) for the preference of each action, the same for each active row."""
    traces: Rows
    """(n_active, actions): the eligibility traces of the preferences; empty for methods without traces."""
    before: Rows
    """(n_active, actions): the preferences before the update."""
    after: Rows
    """(n_active, actions): the preferences after it."""
    probabilities_before: tuple[float, ...]
    """(actions,): π(a | S) before the update."""
    probabilities_after: tuple[float, ...]
    """(actions,): π(a | S) after it."""
    value_before: float | None
    """v(S) before the update; None for methods without state values."""
    value_after: float | None
    """v(S) after it."""
    equations: tuple[str, ...]
    """The equations of the update."""
    numbers: tuple[str, ...]
    """The same equations with their numbers, rounded to six digits."""
    step_sizes: tuple[float, ...] = ()
    """(n_active,): the step size of each active row."""
    features: tuple[float, ...] = ()
    """(n_active,): the features x of S, of which the gradient is a multiple; empty if each is 1."""

    @property
    def preferences(self) -> tuple[float, float]:
        """H(S, A) before and after the update."""
        before, after = (
            total(tuple(row[self.action] for row in rows), self.features) for rows in (self.before, self.after)
        )
        return before, after

    @property
    def policy(self) -> str:
        """The probabilities of all actions before and after the update, as text."""
        before, after = (
            ", ".join(f"{one:.4g}" for one in probabilities)
            for probabilities in (self.probabilities_before, self.probabilities_after)
        )
        return f"π(a | S): {before} -> {after}"


def equations_of(config: Config, update: PolicyUpdate) -> list[tuple[str, str]]:
    """Returns the equations of an update and their numbers; ``update`` has neither yet."""
    algorithm, action = config.algorithm, update.action
    traces = tuple(row[action] for row in update.traces)
    if update.features and traces:
        size, factor = gain(update.rows, update.step_sizes, traces, update.features), 1.0
    elif traces:
        # A preference changes once, however often its row is active.
        size = update.step_size * len(update.rows)
        factor = sum(traces) / len(traces)
    else:
        size = gain(update.rows, update.step_sizes, (), update.features)
        factor = update.gradient[action]
    before, after = update.preferences
    symbols = ERROR[algorithm]
    if update.reward is None or algorithm == "gradient_bandit":
        shown = number(update.target)
    else:
        shown = number(update.reward)
        if update.bootstrap is None:
            symbols = "δ = R - v(S)"
        else:
            shown += f" + {power(number(config.discount), 1, ' · ')}{term(update.bootstrap)}"
    shown += f" - {term(update.reference)} = {number(update.error)}"
    name = "" if algorithm == "gradient_bandit" else "δ = "
    lines = [] if algorithm == "reinforce" else [(symbols, f"{name}{shown}")]
    symbol = SYMBOL.get(algorithm, "δ")
    with_traces = algorithm == "actor_critic_lambda"
    discounts = "" if algorithm == "gradient_bandit" or with_traces else power("γ", update.step, " ")
    step_of = f"{number(size)} · "
    discount = power(number(config.discount), update.step, " · ") if discounts else ""
    if with_traces and update.features:
        gained, direction, times = gain_symbol(update.features, traced=True), "", ""
    else:
        gained, direction = gain_symbol(update.features), " z" if with_traces else " ∇ ln π(A | S)"
        times = f" · {term(factor)}"
    lines.append(
        (
            f"H(S, A) <- H(S, A) + {gained} {discounts}{symbol}{direction}",
            f"H(S, A) <- {number(before)} + {step_of}{discount}{term(update.error)}{times} = {number(after)}",
        )
    )
    return lines
