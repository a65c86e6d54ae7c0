"""Divergence: values that no sum of rewards can have."""

import numpy as np

from qtab.diagnosis.changes import changes
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding

FACTOR = 10.0
"""Values are reported if they are this many times larger than updates without overshoot can make them."""


def divergence(facts: Facts) -> Finding | None:
    """Finds values that overflowed, or that are far larger than the rewards can make them."""
    active = facts.run.discretizer.n_active
    finite = facts.run.tables[np.isfinite(facts.run.tables)]
    largest = float(np.abs(finite).max(initial=0.0)) * active if facts.is_finite else float("inf")
    possible = _largest_possible(facts)
    if largest <= FACTOR * possible:
        return None
    config = facts.config
    lower = config.learning_rate / 4
    return Finding(
        name="divergence",
        title="The values diverged.",
        evidence={"largest value": largest, "largest possible value": possible},
        meaning="Each update overshoots its target, so that the errors grow instead of shrinking.",
        advice=f"lower the learning rate, such as learning_rate={lower:g}"
        + (", or use traces='replacing'" if config.traces == "accumulating" else ""),
        changes=changes(config, {"learning_rate": lower})
        + (changes(config, {"traces": "replacing"}) if config.traces == "accumulating" else ()),
    )


def _largest_possible(facts: Facts) -> float:
    """Returns the largest value that updates can reach if none of them moves a value beyond its target.

    With rewards of at most r it is r / (1 - discount); and as each update adds at most r to the largest value, also r
    times the number of steps, which bounds it without a discount.
    """
    run, config = facts.run, facts.config
    returns, lengths = np.abs(run.episode_returns), np.maximum(run.episode_lengths, 1)
    steps = float(run.episode_lengths.sum())
    reward = float((returns / lengths).max(initial=0.0))
    if facts.sample is not None:
        reward = max(reward, float(np.abs(facts.sample.rewards).max(initial=0.0)))
    reward += config.count_bonus + (config.time_weight or 0.0) * float(np.sqrt(steps))
    ahead = steps if config.discount == 1.0 else min(steps, 1.0 / (1.0 - config.discount))
    initial = facts.initial_tables[np.isfinite(facts.initial_tables)]
    start = float(np.abs(initial).max(initial=0.0)) * run.discretizer.n_active
    # A rare reward may be larger than any in the sample, but hardly larger than the largest return.
    return start + max(float(returns.max(initial=0.0)), 1e-9) + reward * ahead
