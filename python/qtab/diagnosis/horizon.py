"""Horizon: the discount hides the goal."""

import numpy as np

from qtab.diagnosis.facts import LONGEST_MOUNTAIN_CAR, Facts
from qtab.diagnosis.finding import Finding, percent

LEAST_WEIGHT = 0.05
"""With less of its weight left at the start, a goal is hard to tell from no goal."""


def horizon(facts: Facts) -> Finding | None:
    """Finds that of the goal's value almost nothing is left after the shortest route to it."""
    discount, shortest = facts.config.discount, facts.shortest_route
    if shortest is None or discount >= 1.0 or discount**shortest >= LEAST_WEIGHT:
        return None
    ahead = 1.0 / (1.0 - discount)
    evidence: dict[str, float] = {
        "discount": discount,
        "steps ahead": ahead,
        "shortest route": shortest,
        "weight of the goal at the start": discount**shortest,
    }
    route = f"at least {shortest} steps"
    if facts.is_usual_mountain_car:
        evidence["longest shortest route"] = LONGEST_MOUNTAIN_CAR
        route = f"at best {shortest} to {LONGEST_MOUNTAIN_CAR} steps"
    run = facts.run
    meaning = (
        f"The agent looks about {ahead:.3g} steps ahead, 1 / (1 - discount), and the goal is {route} away: "
        f"{percent(discount**shortest)} of its value is left there."
    )
    if (run.episode_returns == -run.episode_lengths).all():  # every step costs 1
        values = facts.q_values.max(axis=1)[facts.visited] * run.discretizer.n_active
        share = float(np.mean(values <= -0.9 * ahead)) if len(values) else 0.0
        evidence[f"share of visited states near the floor {-ahead:.4g}"] = share
        if share > 0:
            meaning += f" Without a goal in sight every state is worth {-ahead:.3g}, and all actions look the same."
    costs = bool((run.episode_returns < 0).all())
    better = 1.0 if costs else float(np.ceil(1000 * (1 - 1 / (5 * shortest))) / 1000)
    return Finding(
        name="horizon",
        title="The discount is too small for the way to the goal.",
        evidence=evidence,
        meaning=meaning,
        advice=f"use discount={better:g}" + (": with a cost for each step the values stay finite" if costs else ""),
        changes=({"discount": better},),
    )
