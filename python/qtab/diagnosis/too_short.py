"""Too short: the returns were still improving when the training ended."""

import numpy as np
from numpy.typing import NDArray

from qtab.diagnosis.changes import changes
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Unchecked
from qtab.results.rates import epsilons

PARTS = 3
"""The last third of the episodes is compared with the one before."""
LEAST_EPISODES = 20
STANDARD_ERRORS = 3.0
LEAST_SHARE = 0.1
"""If the returns improve by a smaller share of the gap to the goal, training would take too long."""
MOST_EPSILON = 0.1
"""With a larger epsilon in the last parts, returns also rise because it falls."""


def too_short(facts: Facts) -> Finding | Unchecked | None:
    """Finds that the last returns are clearly higher than those shortly before."""
    before, last = _parts(facts)
    if len(last) < LEAST_EPISODES:
        return Unchecked("there are too few episodes")
    if not still_improving(facts):
        return None
    more = 5 * facts.config.episodes
    return Finding(
        name="too short",
        title="The training ended while the returns were still improving.",
        evidence={
            "mean return, last third": float(last.mean()),
            "mean return, third before": float(before.mean()),
            "episodes": len(facts.run.episode_returns),
        },
        meaning="The agent was still learning when the training ended.",
        advice=f"train longer, such as episodes={more}",
        changes=changes(facts.config, {"episodes": more}),
    )


def still_improving(facts: Facts) -> bool:
    """Returns whether the last third of the returns is clearly higher than the one before."""
    before, last = _parts(facts)
    if len(last) < LEAST_EPISODES:
        return False
    if facts.config.exploration == "epsilon_greedy":
        rates = epsilons(facts.run)
        if rates[-len(rates) * 2 // PARTS :].max() > MOST_EPSILON:
            return False
    error = float(np.sqrt((before.var() + last.var()) / len(last)))
    improvement = float(last.mean() - before.mean())
    # Without a known goal, the improvement is compared with the gain of the whole run.
    gained = float(last.mean() - facts.run.episode_returns[: len(last)].mean())
    missing = gained if facts.goal_return is None else facts.goal_return - float(before.mean())
    return improvement > STANDARD_ERRORS * error and improvement > LEAST_SHARE * missing


def _parts(facts: Facts) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    returns = facts.run.episode_returns
    size = len(returns) // PARTS
    return returns[len(returns) - 2 * size : len(returns) - size], returns[len(returns) - size :]
