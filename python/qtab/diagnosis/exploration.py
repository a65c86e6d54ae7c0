"""Exploration: the behaviour policy does not reach the goal, or never stops exploring."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, percent
from qtab.diagnosis.rates import epsilons

LEAST_REACHED = 0.01
"""A smaller share of the first half's episodes that reach the goal is reported."""
MOST_EPSILON = 0.2
"""A larger exploration rate at the end is reported."""


def exploration(facts: Facts) -> Finding | None:
    """Finds that hardly any early episode reaches the goal, so that there is nothing to learn from."""
    reached = facts.reached
    if reached is None or len(reached) < 2 or facts.random is None or facts.failure_return is None:
        return None
    half = len(reached) // 2
    early = float(reached[:half].mean())
    if early >= LEAST_REACHED:
        return None
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
        change: Mapping[str, Any] = {"epsilon": 1.0, "epsilon_schedule": "linear", "min_epsilon": 0.0}
        advice = "explore more at first: epsilon=1.0, falling linearly"
        meaning = f"{when}, but {percent(by_chance)} of episodes with random actions do: exploration ends too soon."
    else:
        change = _optimistic(facts)
        advice = f"explore by optimism: {', '.join(f'{name}={value:g}' for name, value in change.items())}"
        meaning = f"{when}. Random actions hardly ever find it, so a larger epsilon does not help."
    if all(getattr(facts.config, name) == value for name, value in change.items()):
        return None  # it explores like this already: something else is wrong
    return Finding(
        name="exploration",
        title="Exploration hardly ever reaches the goal.",
        evidence=evidence,
        meaning=meaning,
        advice=advice,
        changes=(change,),
    )


def lasting_exploration(facts: Facts) -> Finding | None:
    """Finds an exploration rate that is still high at the end."""
    config = facts.config
    if config.exploration != "epsilon_greedy":
        return None
    last = float(epsilons(config, len(facts.run.episode_returns))[-1])
    if last <= MOST_EPSILON:
        return None
    return Finding(
        name="lasting exploration",
        title="The agent still explores a lot at the end.",
        evidence={"epsilon of the last episode": last, "steps between random actions": 1.0 / last},
        meaning=f"One step in {1.0 / last:.2g} is random to the end. Episodes that need many right steps in "
        "a row fail, and on-policy algorithms learn the values of this exploring policy.",
        advice="let epsilon fall to 0: epsilon_schedule='linear', min_epsilon=0.0",
        changes=({"epsilon_schedule": "linear", "min_epsilon": 0.0},),
    )


def _optimistic(facts: Facts) -> Mapping[str, float]:
    """Initial values above every possible return: 0 where steps cost, else the best return."""
    best = max(0.0, float(facts.run.episode_returns.max()))
    return {"epsilon": 0.0, "initial_q": (best or _reward_scale(facts)) / facts.run.discretizer.n_active}


def _reward_scale(facts: Facts) -> float:
    """0 where all rewards are costs; 1 where nothing was ever paid."""
    return 0.0 if facts.run.episode_returns.min() < 0 else 1.0
