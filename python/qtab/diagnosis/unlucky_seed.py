"""Unlucky seed: other seeds of the same settings do better."""

import numpy as np

from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, percent

MOST_BELOW = 0.2
"""Only a run in the lowest fifth is unlucky."""


def unlucky_seed(facts: Facts) -> Finding | None:
    """Finds that most other seeds solve the environment with the same settings, and this one is among the worst."""
    returns, goal = facts.other_returns, facts.goal_return
    if returns is None or goal is None:
        return None
    own = facts.greedy_return if facts.greedy_is_exact else facts.final_return
    solved, below = float(np.mean(returns >= goal)), float(np.mean(returns < own))
    if solved <= 0.5 or below > MOST_BELOW:
        return None
    rank = len(returns) + 1 - int(np.sum(returns < own))
    return Finding(
        name="unlucky seed",
        title="The seed was unlucky.",
        evidence={
            "rank of this seed": rank,
            "seeds": len(returns) + 1,
            "share of the others that solve it": solved,
            "median of the others": float(np.median(returns)),
        },
        meaning=f"With the same settings {percent(solved)} of {len(returns)} other seeds solve the environment.",
        advice="use another seed, and settings with which all seeds succeed, such as more episodes",
        changes=({"episodes": 2 * facts.config.episodes},),
    )
