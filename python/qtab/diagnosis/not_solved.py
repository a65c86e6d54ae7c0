"""Not solved: the returns against the threshold and the optimum."""

from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding


def not_solved(facts: Facts) -> Finding | None:
    """Finds that neither the greedy policy nor the last episodes of training reach the goal."""
    goal = facts.goal_return
    if facts.solved is not False or goal is None:
        return None
    evidence = {"last 100 episodes": facts.final_return, "greedy policy": facts.greedy_return}
    if facts.threshold is not None:
        evidence["threshold"] = facts.threshold
    if facts.best_return is not None:
        evidence["best known"] = facts.best_return
    changes = () if facts.config.preset == "solved" else ({"preset": "solved"},)
    return Finding(
        name="not solved",
        title="The run did not solve its environment.",
        evidence=evidence,
        meaning=f"A return of {goal:.4g} or more counts as solved here.",
        advice="see the findings below; what_if() tries each change over many seeds",
        changes=changes if _has_solved_preset(facts) else (),
    )


def _has_solved_preset(facts: Facts) -> bool:
    from qtab.config.presets import presets

    return "solved" in presets(facts.config.env)
