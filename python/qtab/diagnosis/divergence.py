"""Divergence: values that no sum of rewards can have."""

import numpy as np

from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding

FACTOR = 100.0
"""Values so many times larger than any return are not those of a policy."""


def divergence(facts: Facts) -> Finding | None:
    """Finds values that overflowed, or that are far larger than any return and any initial value."""
    returns = facts.run.episode_returns
    active = facts.run.discretizer.n_active
    finite = facts.run.tables[np.isfinite(facts.run.tables)]
    largest = float(np.abs(finite).max(initial=0.0)) * active if facts.is_finite else float("inf")
    initial = facts.initial_tables[np.isfinite(facts.initial_tables)]
    possible = max(float(np.abs(returns).max(initial=1.0)), float(np.abs(initial).max(initial=0.0)) * active)
    if largest <= FACTOR * possible:
        return None
    lower = facts.config.learning_rate / 4
    return Finding(
        name="divergence",
        title="The values diverged.",
        evidence={"largest value": largest, "largest return or initial value": possible},
        meaning="Each update overshoots its target, so that the errors grow instead of shrinking.",
        advice=f"lower the learning rate, such as learning_rate={lower:g}"
        + (", or use traces='replacing'" if facts.config.traces == "accumulating" else ""),
        changes=({"learning_rate": lower},)
        + (({"traces": "replacing"},) if facts.config.traces == "accumulating" else ()),
    )
