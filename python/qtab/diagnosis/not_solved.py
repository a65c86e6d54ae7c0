"""Not solved: the returns against the threshold and the optimum."""

import math

from qtab.config.presets import presets
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding
from qtab.results.summary import FINAL_EPISODES


def not_solved(facts: Facts) -> Finding | None:
    """Finds that neither the greedy policy nor the last episodes of training reach the goal."""
    goal = facts.goal_return
    if facts.solved is not False or goal is None:
        return None
    last = min(len(facts.run.episode_returns), FINAL_EPISODES)
    evidence = {f"last {last} episodes": facts.final_return}
    if not math.isnan(facts.greedy_return):
        evidence["greedy policy"] = facts.greedy_return
    if facts.threshold is not None:
        evidence["threshold"] = facts.threshold
    if facts.best_return is not None:
        evidence["best known"] = facts.best_return
    has_better = facts.config.preset != "solved" and "solved" in presets(facts.config.env)
    return Finding(
        name="not solved",
        title="The run did not solve its environment.",
        evidence=evidence,
        meaning=f"A return of {goal:.4g} or more counts as solved here.",
        advice="see the findings below; what_if() tries each change over many seeds",
        changes=({"preset": "solved"},) if has_better else (),
    )
