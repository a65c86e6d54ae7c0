"""Exploration: values that were never updated, too little of it, or so much at the end that it costs returns."""

from collections.abc import Mapping
from contextlib import closing
from typing import Any

import numpy as np

from qtab.config.options import PREFERENCES
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Share, Unchecked, as_keywords, change, changes, given, percent
from qtab.diagnosis.learning_rate import overwrites
from qtab.results.rates import epsilons
from qtab.results.words import cell_in_words, map_columns
from qtab.training.setup.run_env import can_be_made, make_run_env

MOST_UNTRIED = 0.2
"""A larger share of untried actions in visited states is reported."""
MOST_UPDATES = 100.0
"""With more updates per tried action, the other actions are untried because the agent avoids them."""
SHOWN = 3


def coverage(facts: Facts) -> Finding | Unchecked | None:
    """Finds that in many visited states some actions were never tried."""
    tried, visited = facts.tried, facts.visited
    entries = facts.has_action & visited[:, np.newaxis]
    if not entries.any():
        return Unchecked("no value changed")
    untried = float(1.0 - tried[entries].mean())
    if untried <= MOST_UNTRIED:
        return None
    run = facts.run
    per_entry = float(run.episode_lengths.sum()) * run.discretizer.n_active / max(int(tried.sum()), 1)
    if per_entry > MOST_UPDATES:
        return None
    states = np.flatnonzero((entries & ~tried).sum(axis=1))
    columns = _columns(facts)
    where = "; ".join(cell_in_words(facts.run, int(row), columns) for row in states[:SHOWN])
    more = 5 * facts.config.episodes
    return Finding(
        title="Many actions were never tried" + (", or their values never changed." if facts.visits is None else "."),
        evidence={
            "share of untried actions in visited states": Share(untried),
            "visited states": int(visited.sum()),
            "states of the table": len(visited),
            "updates per tried action": per_entry,
        },
        meaning=f"{percent(untried)} of the values in visited states are still the initial ones, such as in {where}. "
        "The greedy policy compares them with learned values.",
        advice=f"train longer, such as episodes={more}, explore more, or use fewer cells",
        changes=changes(facts.config, {"episodes": more}, *_coarser(facts)),
    )


def _coarser(facts: Facts) -> tuple[Mapping[str, Any], ...]:
    config = facts.config
    if config.discretizer == "round" and config.scale:
        return ({"scale": tuple(scale / 2 for scale in config.scale)},)
    if config.discretizer == "bins" and config.bins is not None and max(config.bins) > 1:
        return ({"bins": tuple(max(1, count // 2) for count in config.bins)},)
    return ()


def _columns(facts: Facts) -> int | None:
    """Returns the number of columns of the map of numbered states; None if there is no map, or it is not known."""
    if facts.run.discretizer.low.ndim or not can_be_made(facts.config):
        return None
    with closing(make_run_env(facts.config)) as env:
        return map_columns(env)


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
    evidence: dict[str, float] = {
        "share of episodes that reach the goal, first half": Share(early),
        "second half": Share(reached[half:].mean()),
        "by random actions": Share(by_chance),
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
        title="Exploration hardly ever reaches the goal.",
        evidence=evidence,
        meaning=meaning,
        advice=f"explore {how}: {as_keywords(shown)}",
        changes=given([shown]),
    )


def _optimistic(facts: Facts) -> Mapping[str, Any]:
    """Returns initial values above every possible return: 0 if steps cost, else the best return."""
    returns = facts.run.episode_returns
    best = max(0.0, float(returns.max())) or (0.0 if returns.min() < 0 else 1.0)
    return {"epsilon": 0.0, "initial_q": best / facts.run.discretizer.n_active}


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
        title="The agent still explores a lot at the end.",
        evidence={
            "share of the last steps with a worse action": Share(share_worse),
            setting: float(getattr(config, setting)),
            "typical difference between the actions of a state": typical,
        },
        meaning=f"Of its last actions {percent(share_worse)} are worse than the greedy one, of random actions "
        f"{percent(share_worse / random)} would be: a {setting} of {getattr(config, setting):g} is large for the "
        "differences between the values.",
        advice="explore less: " + ", or ".join(map(as_keywords, advised)),
        changes=advised,
    )
