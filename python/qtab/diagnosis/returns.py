"""Returns: the run did not solve its environment, was still improving, or had an unlucky seed."""

import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import last_of
from qtab.config.presets import presets
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Share, Unchecked, changes, percent
from qtab.envs.registry import is_registered
from qtab.results.rates import epsilons
from qtab.training.verdict import judge


def not_solved(facts: Facts) -> Finding | Unchecked | None:
    """Finds that neither the greedy policy nor the last episodes of training reach the goal."""
    verdict = facts.verdict
    goal = verdict.goal.least
    if verdict.solved is None or goal is None:
        return Unchecked(verdict.why_unknown)
    evidence = {last_of(verdict.last, "training episode"): verdict.final_return}
    if verdict.greedy_return is not None:
        evidence["greedy policy"] = verdict.greedy_return
    if verdict.goal.threshold is not None:
        evidence["threshold"] = verdict.goal.threshold
    if facts.best_return is not None:
        evidence["best known"] = facts.best_return
    above = verdict.goal.threshold is not None and verdict.goal.threshold > goal
    known = presets(facts.config.env) if is_registered(facts.config.env) else {}
    has_better = facts.config.preset != "solved" and "solved" in known
    return Finding(
        title="The run did not solve its environment.",
        evidence=evidence,
        meaning=f"A return of {goal:.4g} or more counts as solved here"
        + (": no policy reaches the threshold." if above else "."),
        advice="see the findings below; what_if() tries each change over many seeds",
        changes=changes(facts.config, {"preset": "solved"}) if has_better else (),
    )


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
        title="The seed was unlucky.",
        evidence={
            "rank of this seed": rank,
            "seeds": len(returns) + 1,
            "share of the others that solve it": Share(solved),
            "median of the others": float(np.median(returns)),
        },
        meaning=f"With the same settings {percent(solved)} of {len(returns)} other seeds solve the environment.",
        advice="use another seed, and settings that succeed with all seeds, such as more episodes",
        changes=changes(facts.config, {"episodes": 2 * facts.config.episodes}),
    )
