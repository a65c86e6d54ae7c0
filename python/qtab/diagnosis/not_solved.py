"""Not solved: the returns against the threshold and the optimum."""

from qtab.config.presets import presets
from qtab.diagnosis.changes import changes
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Unchecked


def not_solved(facts: Facts) -> Finding | Unchecked | None:
    """Finds that neither the greedy policy nor the last episodes of training reach the goal."""
    verdict = facts.verdict
    goal = verdict.goal.least
    if verdict.solved is None or goal is None:
        return Unchecked(verdict.why_unknown)
    evidence = {f"last {verdict.last} training episodes": verdict.final_return}
    if verdict.greedy_return is not None:
        evidence["greedy policy"] = verdict.greedy_return
    if verdict.goal.threshold is not None:
        evidence["threshold"] = verdict.goal.threshold
    if facts.best_return is not None:
        evidence["best known"] = facts.best_return
    above = verdict.goal.threshold is not None and verdict.goal.threshold > goal
    has_better = facts.config.preset != "solved" and "solved" in presets(facts.config.env)
    return Finding(
        name="not solved",
        title="The run did not solve its environment.",
        evidence=evidence,
        meaning=f"A return of {goal:.4g} or more counts as solved here"
        + (": no policy reaches the threshold." if above else "."),
        advice="see the findings below; what_if() tries each change over many seeds",
        changes=changes(facts.config, {"preset": "solved"}) if has_better else (),
    )
