"""Time limit: episodes end before the goal can be reached."""

from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, percent
from qtab.envs.goals import own_time_limit

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
        name="short time limit",
        title="The time limit may be too short to reach the goal.",
        evidence={
            "time limit": limit,
            "the environment's own": own,
            "share of episodes that time out": timed_out,
        },
        meaning=f"{percent(timed_out)} of the episodes end by the time limit, after fewer steps than the environment "
        "allows.",
        # Returns under different limits cannot be compared, so that what_if does not try this.
        advice=f"use the environment's own limit, max_episode_steps={own}",
    )
