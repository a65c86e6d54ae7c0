"""Exploration: the behaviour policy does not reach the goal."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from qtab.diagnosis.changes import change, given
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Unchecked, as_keywords, percent
from qtab.diagnosis.learning_rate import overwrites

LEAST_REACHED = 0.01
"""A smaller share of the first half's episodes that reach the goal is reported, unless ``ENOUGH_REACHED`` do."""
ENOUGH_REACHED = 20
"""With at least this many episodes that reach the goal, nothing is reported."""


def exploration(facts: Facts) -> Finding | Unchecked | None:
    """Finds that hardly any early episode reaches the goal, so that there is nothing to learn from."""
    reached = facts.reached
    if reached is None or facts.random is None or facts.failure_return is None:
        return Unchecked("random actions do not mostly fail with the same return")
    if len(reached) < 2:
        return Unchecked("there is only one episode")
    half = len(reached) // 2
    early = float(reached[:half].mean())
    if early >= LEAST_REACHED or reached[:half].sum() >= ENOUGH_REACHED:
        return None
    if reached[:half].any() and overwrites(facts):
        return None  # it found the goal, and forgot it
    by_chance = float((facts.random.episode_returns > facts.failure_return).mean())
    first = int(np.argmax(reached)) if reached.any() else None
    evidence = {
        "share of episodes that reach the goal, first half": early,
        "second half": float(reached[half:].mean()),
        "by random actions": by_chance,
    }
    if first is not None:
        evidence["first episode that reaches it"] = first
    when = "No episode reaches the goal" if first is None else f"Episode {first:,} is the first to reach the goal"
    if by_chance > LEAST_REACHED / 2 and facts.config.exploration == "epsilon_greedy":
        changed = change(facts.config, epsilon=1.0, epsilon_schedule="linear", min_epsilon=0.0)
        how, meaning = "more at first", f"{when}, but {percent(by_chance)} of episodes with random actions do: "
        meaning += "exploration ends too soon."
    else:
        changed = change(facts.config, exploration="epsilon_greedy", **_optimistic(facts))
        how, meaning = "by optimism", f"{when}. Random actions hardly ever find it, so more of them do not help."
    if changed is None:
        return None  # the advised exploration is in use already
    shown = {name: value for name, value in changed.items() if getattr(facts.config, name) != value}
    return Finding(
        name="exploration",
        title="Exploration hardly ever reaches the goal.",
        evidence=evidence,
        meaning=meaning,
        advice=f"explore {how}: {as_keywords(shown)}",
        changes=given([shown]),
    )


def _optimistic(facts: Facts) -> Mapping[str, Any]:
    """Returns initial values above every possible return: 0 if steps cost, else the best return."""
    best = max(0.0, float(facts.run.episode_returns.max()))
    return {"epsilon": 0.0, "initial_q": (best or _reward_scale(facts)) / facts.run.discretizer.n_active}


def _reward_scale(facts: Facts) -> float:
    """Returns 0 if there are costs, else 1."""
    return 0.0 if facts.run.episode_returns.min() < 0 else 1.0
