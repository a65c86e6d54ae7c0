"""Unlucky seed: other seeds of the same settings do better."""

import numpy as np

from qtab.diagnosis.changes import changes
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Unchecked, percent
from qtab.training.verdict import judge

MOST_BELOW = 0.2
"""Only a run in the lowest fifth is unlucky."""


def unlucky_seed(facts: Facts) -> Finding | Unchecked | None:
    """Finds that most other seeds solve the environment with the same settings, and this one is among the worst."""
    if facts.goal_return is None:
        return Unchecked("no return counts as solved")
    if facts.others is None:
        return Unchecked("no other seeds were trained")
    verdicts = [judge(run, facts.optimum) for run in facts.others]
    # Training returns include exploration: they rank the seeds only if the greedy policy's return is not exact.
    if facts.verdict.greedy_is_exact:
        own, returns = facts.verdict.greedy_return, np.array([verdict.greedy_return for verdict in verdicts])
    else:
        own, returns = facts.verdict.final_return, np.array([verdict.final_return for verdict in verdicts])
    solved = float(np.mean([verdict.solved is True for verdict in verdicts]))
    below = float(np.mean(returns < own))
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
        advice="use another seed, and settings that succeed with all seeds, such as more episodes",
        changes=changes(facts.config, {"episodes": 2 * facts.config.episodes}),
    )
