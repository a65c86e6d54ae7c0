"""Time: the discount hides what is far away, the limit is too short, or time-outs are treated as terminal states."""

import numpy as np

from qtab.config.options import FIXED, fixed_settings
from qtab.diagnosis.facts import LONGEST_MOUNTAIN_CAR, Facts
from qtab.diagnosis.finding import Finding, Share, Unchecked, as_keywords, changes, percent
from qtab.envs.metadata.goals import own_time_limit

LEAST_WEIGHT = 0.05
"""A smaller weight of the goal at the start is reported: with it, a goal is hard to tell from no goal."""
SHORT_SIGHTED = 0.5
"""A discount up to this one lets the agent look at most two steps ahead, and is reported if episodes are long."""
OTHER_ALGORITHM = "q_learning"
"""The algorithm that is advised instead of one without a discount."""


def horizon(facts: Facts) -> Finding | Unchecked | None:
    """Finds that almost nothing of the goal's value is left at the start of the shortest route to it."""
    discount = facts.config.discount
    if discount == 1.0:
        return None
    shortest = facts.shortest_route
    is_known = shortest is not None
    if shortest is None:
        if discount > SHORT_SIGHTED:
            return Unchecked("no way to a goal is known")
        shortest = int(np.median(facts.run.episode_lengths))
    if shortest < 2 or discount**shortest >= LEAST_WEIGHT:
        return None
    ahead = 1.0 / (1.0 - discount)
    evidence: dict[str, float] = {
        "discount": discount,
        "steps ahead": ahead,
        "shortest route" if is_known else "median episode length": shortest,
        "weight of the goal at the start" if is_known else "weight of its last reward at the start": Share(
            discount**shortest
        ),
    }
    route = f"at least {shortest} steps"
    if facts.is_usual_mountain_car:
        evidence["longest shortest route"] = LONGEST_MOUNTAIN_CAR
        route = f"at best {shortest} to {LONGEST_MOUNTAIN_CAR} steps"
    run = facts.run
    way = f"the goal is {route} away" if is_known else f"half of the episodes have {route}"
    meaning = (
        f"The agent looks about {ahead:.3g} {'step' if ahead == 1 else 'steps'} ahead, 1 / (1 - discount), and {way}: "
        f"{percent(discount**shortest)} of {'its value' if is_known else 'the value of their end'} is left there."
    )
    if (run.episode_returns == -run.episode_lengths).all():  # every step costs 1
        values = facts.q_values.max(axis=1)[facts.visited] * run.discretizer.n_active
        share = float(np.mean(values <= -0.9 * ahead)) if len(values) else 0.0
        evidence[f"share of visited states near the floor {-ahead:.4g}"] = Share(share)
        if share > 0:
            meaning += f" Without a goal in sight every state is worth {-ahead:.3g}, and all actions look the same."
    costs = bool((run.episode_returns < 0).all())
    better = 1.0 if costs else float(np.ceil(1000 * (1 - 1 / (5 * shortest))) / 1000)
    algorithm = facts.config.algorithm
    if "discount" in fixed_settings(algorithm):
        title = f"The algorithm, {algorithm}, {FIXED[algorithm].reason}."
        other = {"algorithm": OTHER_ALGORITHM, "exploration": "epsilon_greedy", "discount": better}
        advice = f"use an algorithm that has a discount: {as_keywords(other)}"
    else:
        title, other = "The discount is too small for the distance to the goal.", {"discount": better}
        advice = f"use {as_keywords(other)}"
    return Finding(
        title=title,
        evidence=evidence,
        meaning=meaning,
        advice=advice + (": with a cost for each step the values stay finite" if costs else ""),
        changes=changes(facts.config, other),
    )


MOST_TIMED_OUT = 0.99
"""A larger share of episodes that time out is reported if the limit is below the environment's own."""


def time_limit(facts: Facts) -> Finding | None:
    """Finds that hardly any episode ends before a time limit that is shorter than the environment's own."""
    limit, own = facts.config.max_episode_steps, own_time_limit(facts.config.env)
    if limit is None or own is None or limit >= own:
        return None
    timed_out = float((~facts.run.terminated).mean())
    if timed_out <= MOST_TIMED_OUT:
        return None
    return Finding(
        title="The time limit may be too short to reach the goal.",
        evidence={
            "time limit": limit,
            "the environment's own": own,
            "share of episodes that time out": Share(timed_out),
        },
        meaning=f"{percent(timed_out)} of the episodes end by the time limit, after fewer steps than the environment "
        "allows.",
        # Returns under different limits cannot be compared, so that what_if does not try this.
        advice=f"use the environment's own limit, max_episode_steps={own}",
    )


def truncation(facts: Facts) -> Finding | None:
    """Finds time-outs that are treated as terminal states."""
    timed_out = int((~facts.run.terminated).sum())
    if facts.config.on_truncation != "terminate" or facts.config.time_aware or timed_out == 0:
        return None
    if "on_truncation" in fixed_settings(facts.config.algorithm):
        return None
    share = timed_out / len(facts.run.terminated)
    return Finding(
        title="Time-outs are treated as terminal states.",
        evidence={"episodes that timed out": timed_out, "share of all episodes": Share(share)},
        meaning=f"{percent(share)} of the episodes end by the time limit. The state where that happens depends on the "
        "clock, which the agent does not see, and its value is learned as if nothing followed.",
        advice="use on_truncation='bootstrap': the value of the last state then counts",
        changes=changes(facts.config, {"on_truncation": "bootstrap"}),
    )
