"""The learning rate: values that diverge, that are still far from their targets, or that are noisy."""

import numpy as np
from numpy.typing import NDArray

from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Share, Unchecked, as_keywords, changes, percent
from qtab.diagnosis.returns import still_improving
from qtab.results.rates import learning_rates
from qtab.training.train import train

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


MOST_LEFT = 0.3
"""A larger share of the initial values left in the values is reported."""
ENOUGH_LEFT = 0.05
MOST_NOISE = 0.12
"""A larger change of the values over the last tenth of the episodes, relative to their spread, is reported."""
MOST_DRIFT = 0.95
"""If a larger share of the change is in one direction, the values are not noisy but not yet learned."""
LEAST_CHANCE = 0.05
"""If the results of a smaller share of steps vary, any learning rate is fine."""
LEAST_RATE = 0.05
"""A smaller learning rate does not cause noise."""
OVERWRITING_RATE = 0.5
"""With a larger one, the last few targets make up most of a value."""


def slow_learning(facts: Facts) -> Finding | Unchecked | None:
    """Finds that the learning rate is too small for the number of updates."""
    episodes, rates = learning_rates(facts.run)
    updated = int(facts.tried.sum())
    if facts.config.learning_rate_schedule == "visits":
        return None  # such rates average the targets
    if updated == 0:
        return Unchecked("no value changed")
    updates = float(facts.run.episode_lengths.sum()) * facts.run.discretizer.n_active / updated
    rate = float(np.average(rates, weights=facts.run.episode_lengths[episodes]))
    left = (1.0 - min(rate, 1.0)) ** updates
    if left <= MOST_LEFT:
        return None
    # The rate that leaves little of the initial value, with the same schedule.
    needed = (1.0 - ENOUGH_LEFT ** (1.0 / updates)) * facts.config.learning_rate / rate if rate > 0 else 1.0
    faster = min(float(f"{1.2 * needed:.1g}"), 1.0)
    # If results vary, such a rate would keep only the last of them.
    is_faster = facts.config.learning_rate < faster and not (faster >= OVERWRITING_RATE and _varies(facts))
    longer = {"episodes": 5 * facts.config.episodes}
    return Finding(
        title="The learning rate is too small for so few updates.",
        evidence={"mean learning rate": rate, "updates per value": updates, "initial value left": Share(left)},
        meaning=f"After {updates:,.3g} updates {percent(left)} of the initial value is still in a value.",
        advice=(f"use a larger learning rate, such as learning_rate={faster:g}, or " if is_faster else "")
        + f"train longer, such as episodes={longer['episodes']}",
        changes=changes(facts.config, {"learning_rate": faster} if is_faster else longer),
    )


def overwrites(facts: Facts) -> bool:
    """Returns whether chance decides the values: the last few targets make up most of each, and results vary."""
    config = facts.config
    if config.discretizer != "identity" or config.learning_rate_schedule == "visits":
        return False
    rate = float(learning_rates(facts.run)[1][-1])
    return rate >= OVERWRITING_RATE and _varies(facts)


def _varies(facts: Facts) -> bool:
    """Returns whether the same action in the same state has different results."""
    return facts.sample is not None and facts.sample.mixed_outcomes >= LEAST_CHANCE


def noisy_values(facts: Facts) -> Finding | Unchecked | None:
    """Finds that the values still jump up and down, because the learning rate stays high while results vary."""
    run, config = facts.run, facts.config
    rate = float(learning_rates(facts.run)[1][-1])
    if rate < LEAST_RATE or config.learning_rate_schedule == "visits":
        return None
    if facts.sample is None or len(run.episode_returns) < 10:
        return Unchecked("there are too few episodes" if facts.is_finite else "values overflowed")
    if not _varies(facts) or (facts.reached is not None and not facts.reached.any()):
        return None  # without a reached goal, there is nothing to forget
    if config.count_bonus > 0.0:
        return Unchecked("the count bonus moves the values")
    overwritten = overwrites(facts)
    if still_improving(facts) and not overwritten:
        return Unchecked("the returns were still improving")
    change, spread, drift = _movement(facts)
    if not overwritten and (spread == 0.0 or change / spread <= MOST_NOISE or drift > MOST_DRIFT * change):
        return None
    targets = max(1.0, 2.0 / rate - 1.0)
    few = "the last target" if targets < 1.5 else f"about {targets:.2g} targets"
    share = f"by {percent(change / spread)} of their spread, " if spread > 0.0 else ""
    moves = f"The values move {share}up and down with chance" if change > 0.0 else "What was learned is forgotten again"
    advised = changes(
        config, {"learning_rate": float(f"{config.learning_rate / 10:.4g}")}, {"learning_rate_schedule": "linear"}
    )
    return Finding(
        title="The values are still noisy at the end.",
        evidence={
            "learning rate of the last episode": rate,
            "mean change in the last tenth of the episodes": change,
            "spread of the values": spread,
        },
        meaning=f"{moves}: with a learning rate of {rate:g} a value is an average over {few} only.",
        advice=f"use a smaller learning rate, or let it fall: {', or '.join(map(as_keywords, advised))}",
        changes=advised,
    )


def _movement(facts: Facts) -> tuple[float, float, float]:
    """Returns the mean size of changes in the last tenth of the run, the spread of the values, and the net change."""
    before = len(facts.run.episode_returns) * 9 // 10
    earlier = train(
        config=facts.config, callback=lambda done: done.episodes < before, callback_every=before, progress=False
    ).tables.mean(axis=0)
    differences = facts.q_values - np.where(np.isfinite(earlier), earlier, facts.q_values)
    moved = facts.changed & (differences != 0.0)
    if not moved.any():
        return 0.0, 0.0, 0.0
    change, drift = float(np.abs(differences[moved]).mean()), float(np.abs(differences[moved].mean()))
    return change, _spread(facts.q_values[facts.changed]), drift


def _spread(values: NDArray[np.float64]) -> float:
    """Returns the range of the middle 90 % of the values."""
    low, high = np.percentile(values, [5, 95])
    return float(high - low)
