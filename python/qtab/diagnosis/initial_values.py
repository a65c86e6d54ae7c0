"""Initial values: so high that they are still in the values, or so low that no untried action is ever chosen."""

import numpy as np

from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Share, Unchecked, changes, percent
from qtab.results.rates import epsilons

MOST_STATES = 0.3
"""A larger share of visited states is reported."""
LITTLE_EPSILON = 0.05


def too_optimistic(facts: Facts) -> Finding | Unchecked | None:
    """Finds visited states whose best value is higher than any return can be."""
    active, visited = facts.run.discretizer.n_active, facts.visited
    initial = facts.initial_tables[np.isfinite(facts.initial_tables)]
    highest = float(initial.max(initial=-np.inf)) * active
    possible = max(0.0, float(facts.run.episode_returns.max(initial=0.0)), _best_value(facts))
    if highest <= possible + 1e-9 * abs(possible):
        return None
    if not visited.any() or active > 1:
        return Unchecked("a value is a sum over tilings" if active > 1 else "no value changed")
    share = float(np.mean(facts.q_values[visited].max(axis=1) > possible))
    if share <= MOST_STATES:
        return None
    return Finding(
        title="The initial values are too high to be unlearned in time.",
        evidence={
            "highest initial value": highest,
            "highest possible return": possible,
            "share of visited states above it": Share(share),
        },
        meaning=f"In {percent(share)} of the visited states the best value is still higher than any return can be: the "
        "agent still tries actions that look promising only because they are new.",
        advice=f"use lower initial values, such as initial_q={possible:g}, or train longer",
        changes=changes(facts.config, {"initial_q": possible}),
    )


def too_pessimistic(facts: Facts) -> Finding | Unchecked | None:
    """Finds visited states whose untried actions look worse than the first one tried, without exploration."""
    config, visited = facts.config, facts.visited
    if config.exploration != "epsilon_greedy":
        return None  # it tries all actions
    if not visited.any():
        return Unchecked("no value changed")
    epsilon = float(epsilons(facts.run).mean())
    if epsilon > LITTLE_EPSILON:
        return None
    untried = ~facts.tried & facts.has_action
    values = facts.q_values
    hidden = (untried & (values < values.max(axis=1, keepdims=True))).any(axis=1) & visited
    greedy_tried = facts.tried[np.arange(len(values)), values.argmax(axis=1)]
    share = float(np.mean((hidden & greedy_tried)[visited]))
    if share <= MOST_STATES:
        return None
    best = max(0.0, float(facts.run.episode_returns.max()), _best_value(facts)) / facts.run.discretizer.n_active
    return Finding(
        title="The initial values are too low for so little exploration.",
        evidence={
            "mean epsilon": epsilon,
            "share of visited states with untried actions that look worse": Share(share),
        },
        meaning=f"In {percent(share)} of the visited states an action was never tried, because the values of those "
        "that were tried are higher than the initial ones.",
        advice=f"use higher initial values, such as initial_q={best:g}, or a larger epsilon",
        changes=changes(config, {"initial_q": best}, {"epsilon": 0.2}),
    )


def _best_value(facts: Facts) -> float:
    return -np.inf if facts.optimum is None else float(facts.optimum.values.max())
