"""Lasting exploration: the behaviour policy still takes many actions that it knows to be worse when training ends."""

from typing import Any

import numpy as np

from qtab.config.options import PREFERENCES
from qtab.diagnosis.changes import change, changes, given
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Unchecked, as_keywords, percent
from qtab.results.rates import epsilons

MOST_EPSILON = 0.2
"""A larger exploration rate at the end is reported."""
MOST_RANDOM = 0.35
"""For softmax and upper confidence bounds, a policy that is closer to a random one at the end is reported."""


def lasting_exploration(facts: Facts) -> Finding | Unchecked | None:
    """Finds exploration that is still strong at the end."""
    if facts.config.algorithm in PREFERENCES:
        return Unchecked("it learned the policy itself")
    if facts.config.exploration == "epsilon_greedy":
        return _of_epsilon(facts)
    return _of_values(facts)


def lasting_bonus(facts: Facts) -> Finding | Unchecked | None:
    """Finds a count bonus that still outweighs the rewards at the end."""
    config, run = facts.config, facts.run
    if config.count_bonus == 0.0:
        return None
    if facts.visits is None:
        return Unchecked("the visits are not known")
    # The mean bonus of a step at the end, weighted by the visits n of each state and action.
    counts = facts.visits[facts.visits > 0].astype(np.float64)
    bonus = config.count_bonus * float(np.average(1.0 / np.sqrt(counts), weights=counts))
    length = float(run.episode_lengths.mean())
    returns = run.episode_returns[run.episode_returns != 0.0]
    paid = float(np.median(np.abs(returns))) if len(returns) else 0.0
    if bonus * length <= paid:
        return None
    lower = float(f"{0.1 * config.count_bonus * paid / (bonus * length):.1g}")
    return Finding(
        name="lasting bonus",
        title="The bonus of exploration outweighs the rewards to the end.",
        evidence={
            "bonus of a step at the end": bonus,
            "bonus of an episode": bonus * length,
            "median of the returns other than 0": paid,
        },
        meaning="The values are mostly those of the bonus, so that the greedy policy looks for rarely visited states.",
        advice=f"use a smaller bonus, such as count_bonus={lower:g}",
        changes=changes(config, {"count_bonus": lower}),
    )


def _of_epsilon(facts: Facts) -> Finding | None:
    last = float(epsilons(facts.run)[-1])
    if last <= MOST_EPSILON:
        return None
    return Finding(
        name="lasting exploration",
        title="The agent still explores a lot at the end.",
        evidence={"epsilon of the last episode": last, "steps between random actions": 1.0 / last},
        meaning=f"One step in {1.0 / last:.2g} is random to the end. Episodes that need many right steps in "
        "a row fail, and on-policy algorithms learn the values of this exploring policy.",
        advice="let epsilon fall to 0: epsilon_schedule='linear', min_epsilon=0.0",
        changes=changes(facts.config, {"epsilon_schedule": "linear", "min_epsilon": 0.0}),
    )


def _of_values(facts: Facts) -> Finding | Unchecked | None:
    """Finds that many of the last steps of softmax or upper confidence bounds take an action with a lower value."""
    sample, config = facts.sample, facts.config
    if sample is None:
        return Unchecked("its last steps cannot be replayed")
    values = facts.q_values[sample.rows].sum(axis=1)
    best = values.max(axis=1)
    known = np.where(np.isfinite(values), values, best[:, np.newaxis])
    spread, possible = best - known.min(axis=1), np.isfinite(values).sum(axis=1)
    worse = values[np.arange(len(values)), sample.columns] < best - 1e-9 * np.abs(best)
    differs = (spread > 0) & (possible > 1)
    if not differs.any():
        return Unchecked("all actions look the same")
    share_worse = float(worse[differs].mean())
    random = share_worse / float((1.0 - 1.0 / possible[differs]).mean())
    if random <= MOST_RANDOM:
        return None
    typical = float(np.median(spread[differs]))
    setting, share = ("temperature", 10.0) if config.exploration == "softmax" else ("confidence", 1.0)
    lower: dict[str, Any] = {setting: float(f"{typical / share:.1g}")}
    greedy: dict[str, Any] = {"epsilon": 1.0, "epsilon_schedule": "linear", "min_epsilon": 0.0}
    tried = [change(config, **lower)] if lower[setting] < getattr(config, setting) else []
    tried.append(change(config, exploration="epsilon_greedy", **greedy))
    advised = given(tried)
    return Finding(
        name="lasting exploration",
        title="The agent still explores a lot at the end.",
        evidence={
            "share of the last steps with a worse action": share_worse,
            setting: float(getattr(config, setting)),
            "typical difference between the actions of a state": typical,
        },
        meaning=f"Of its last actions {percent(share_worse)} are worse than the greedy one, of random actions "
        f"{percent(share_worse / random)} would be: a {setting} of {getattr(config, setting):g} is large for the "
        "differences between the values.",
        advice="explore less: " + ", or ".join(map(as_keywords, advised)),
        changes=advised,
    )
