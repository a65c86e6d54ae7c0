"""The settings that the playground shows: their sentences, symbols and defaults are those of :class:`qtab.Config`."""

import re
from collections.abc import Mapping
from typing import Any

from qtab.config.choices import CHOICES
from qtab.config.config import DEFAULTS
from qtab.config.explanations import default, explanations, groups
from qtab.config.options import AVERAGE_REWARD, MONTE_CARLO, OPTIONS, PREFERENCES, mismatch

LEFT_OUT = frozenset(
    (
        *("env", "env_kwargs", "backend", "seed", "preset", "action_mask", "shape", "max_rows", "hashed_rows"),
        *("edges", "actions", "sigma", "target_policy", "model", "priority_threshold", "reward_learning_rate"),
        *("count_bonus", "baseline", "value_learning_rate", "confidence"),
    )
)
"""What the page does not offer: settings of Python environments, those too long for a control, and options of choices
that it does not offer."""

NOT_OFFERED = frozenset(
    (
        *("edges", "ucb", "n_step_tree_backup", "n_step_q_sigma", "prioritized_sweeping"),
        *(*MONTE_CARLO, *AVERAGE_REWARD, *PREFERENCES),
    )
)
"""The choices that the page does not offer: it shows one-step methods, traces and planning with action values."""

# Types and ranges of the controls. A range is inside the one that the config allows, which a test checks.
_CONTROLS: Mapping[str, tuple[str, float | None, float | None, bool]] = {
    "max_episode_steps": ("integer", 1, 10_000, True),
    "episodes": ("integer", 1, 50_000, True),
    "learning_rate": ("number", 0, 1, False),  # up to 2 with tile coding
    "discount": ("number", 0, 1, False),
    "min_learning_rate": ("number", 0, 1, False),
    "learning_rate_decay": ("number", 0, 1, False),
    "learning_rate_warm_up": ("integer", 0, 50_000, False),
    "trace_decay": ("number", 0, 1, False),
    "trace_cutoff": ("number", 0, 1, False),
    "n_steps": ("integer", 1, 256, True),
    "planning_steps": ("integer", 0, 100, False),
    "time_weight": ("number", 0, 1, False),
    "initial_q": ("initial_q", -100, 100, False),
    "epsilon": ("number", 0, 1, False),
    "min_epsilon": ("number", 0, 1, False),
    "epsilon_decay": ("number", 0, 1, False),
    "epsilon_warm_up": ("integer", 0, 50_000, False),
    "temperature": ("number", 0.01, 100, True),
    "scale": ("numbers", 0.1, 1000, True),
    "tilings": ("integer", 1, 32, False),
    "tiles": ("integers", 1, 64, False),
    "bins": ("integers", 1, 100, False),
    "low": ("numbers", None, None, False),
    "high": ("numbers", None, None, False),
}

_TITLES = {
    "q_learning": "Q-learning",
    "expected_sarsa": "Expected Sarsa",
    "double_q_learning": "Double Q-learning",
    "n_step_sarsa": "n-step Sarsa",
    "sarsa_lambda": "Sarsa(λ)",
    "true_online_sarsa_lambda": "True online Sarsa(λ)",
    "watkins_q_lambda": "Watkins's Q(λ)",
    "dyna_q": "Dyna-Q",
    "dyna_q_plus": "Dyna-Q+",
    "round": "Rounding",
    "bins": "Bins",
    "tiles": "Tile coding",
    "identity": "None: states are numbers",
    "epsilon_greedy": "ε-greedy",
    "visits": "By visits",
    "PCG64": "PCG64",
    "MT19937": "MT19937",
}
# Where the config's sentence speaks of what the page does not offer.
_SENTENCES = {
    "max_episode_steps": "The time limit of an episode, in steps.",
    "initial_q": "The initial Q table: drawn uniformly from a range (low, high), or one number everywhere.",
    "learning_rate": "α: the fraction of the error that an update corrects, in [0, 1]. With tile coding it is divided "
    "among the tilings, and may be up to 2.",
    "exploration": "How the agent chooses actions: a random one at times, or by the softmax of the values.",
    "discretizer": "How observations index the Q table: rounded to a grid, by bins of equal width, or by tile coding.",
}
_SYMBOL = re.compile(r"(\w): ")


def title(word: str) -> str:
    """Returns the name of a choice as people write it."""
    return _TITLES.get(word) or word.replace("_", " ").capitalize()


def offered(name: str) -> tuple[str, ...]:
    """Returns the names that a setting chooses from on the page; none for a setting that is no choice."""
    return tuple(word for word in CHOICES.get(name, ()) if word not in NOT_OFFERED)


def setting(name: str, group: str) -> dict[str, Any]:
    """Returns the description of a setting for the page."""
    text = _SENTENCES.get(name) or explanations().get(name, "")
    symbol = _SYMBOL.match(text)
    sentence = text[symbol.end() :] if symbol else text
    choices = offered(name)
    kind, low, high, log = ("choice", None, None, False) if choices else _CONTROLS[name]
    option = OPTIONS.get(name)
    values = [value for value in option.values if value not in NOT_OFFERED] if option else []
    return {
        "symbol": symbol[1] if symbol else None,
        "group": group,
        "sentence": sentence[:1].upper() + sentence[1:],
        "type": kind,
        "choices": [{"value": word, "title": title(word)} for word in choices] or None,
        "default": default(name),
        "low": low,
        "high": high,
        "log": log,
        "applies": None if option is None else {"choice": option.choice, "values": values},
    }


def settings() -> dict[str, dict[str, Any]]:
    """Returns every setting of the page by its name; the groups in the config's order."""
    grouped = groups(name for name in DEFAULTS if name not in LEFT_OUT)
    return {name: setting(name, group) for group, names in grouped.items() for name in names}


def rules() -> list[dict[str, Any]]:
    """Returns the pairs of choices that exclude each other, with the reason in words."""
    found = []
    for name in ("terminal_update", "learning_rate_schedule", "algorithm"):
        for value in offered(name):
            for other in ("algorithm", "discretizer"):
                for chosen in offered(other):
                    if other == name:
                        continue
                    if reason := mismatch(name, value, {**DEFAULTS, other: chosen}):
                        found.append({"setting": name, "value": value, "unless": {other: chosen}, "reason": reason})
    return found
