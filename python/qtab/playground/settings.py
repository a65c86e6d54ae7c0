"""The settings that the playground shows, with the sentences, symbols and defaults of :class:`qtab.Config`."""

import re
from collections.abc import Mapping
from typing import Any

from qtab.config.choices import ALGORITHM_NAMES
from qtab.config.config import DEFAULTS
from qtab.config.help import default, explanations, groups
from qtab.config.implied import weighted_defaults
from qtab.config.options import DEFAULTS_OF_WEIGHTED, OPTIONS
from qtab.config.validation import mismatch

OFFERED: Mapping[str, tuple[str, ...]] = {
    "algorithm": (
        "q_learning",
        "sarsa",
        "expected_sarsa",
        "double_q_learning",
        "n_step_sarsa",
        "sarsa_lambda",
        "true_online_sarsa_lambda",
        "watkins_q_lambda",
        "dyna_q",
        "dyna_q_plus",
    ),
    "learning_rate_schedule": ("constant", "linear", "exponential", "visits"),
    "traces": ("accumulating", "replacing", "clearing"),
    "terminal_update": ("target", "assign"),
    "on_truncation": ("bootstrap", "terminate"),
    "exploration": ("epsilon_greedy", "softmax"),
    "epsilon_schedule": ("constant", "linear", "exponential"),
    "ties": ("first", "random"),
    "discretizer": ("round", "bins", "tiles", "fourier", "identity"),
    "bit_generator": ("PCG64", "MT19937"),
}
"""The choices that the page offers, limited to those of rust/web/src/settings. The others need Python."""

MAX_FEATURES = 256
"""The largest number of Fourier features, as in rust/web/src/settings/discretizer.rs."""

LEFT_OUT = frozenset(
    (
        *("env", "env_kwargs", "backend", "seed", "preset", "action_mask", "shape", "max_rows", "hashed_rows"),
        *("edges", "actions", "model", "count_bonus", "time_aware"),
    )
)
"""The settings that the page omits: those of Python environments, those too long for a control, and those that always
have their defaults on the page."""

# Types and ranges of the controls. A range lies within that of the config, which a test checks.
_CONTROLS: Mapping[str, tuple[str, float | None, float | None, bool]] = {
    "max_episode_steps": ("integer", 1, 10_000, True),
    "episodes": ("integer", 1, 100_000, True),
    "learning_rate": ("number", 0, 1, False),  # up to 2 without cells
    "discount": ("number", 0, 1, False),
    "min_learning_rate": ("number", 0, 1, False),
    "learning_rate_decay": ("number", 0, 1, False),
    "learning_rate_warm_up": ("integer", 0, 99_999, False),
    "trace_decay": ("number", 0, 1, False),
    "trace_cutoff": ("number", 0, 1, False),
    "n_steps": ("integer", 1, 256, True),
    "planning_steps": ("integer", 0, 100, False),
    "time_weight": ("number", 0, 1, False),
    "initial_q": ("initial_q", -100, 100, False),
    "epsilon": ("number", 0, 1, False),
    "min_epsilon": ("number", 0, 1, False),
    "epsilon_decay": ("number", 0, 1, False),
    "epsilon_warm_up": ("integer", 0, 99_999, False),
    "temperature": ("number", 0.01, 100, True),
    "scale": ("numbers", 0.1, 1000, True),
    "tilings": ("integer", 1, 32, False),
    "tiles": ("integers", 1, 64, False),
    "bins": ("integers", 1, 100, False),
    "order": ("integer", 1, 20, False),  # fewer if the features are coupled
    "coupled": ("flag", None, None, False),
    "scale_step_sizes": ("flag", None, None, False),
    "low": ("numbers", None, None, False),
    "high": ("numbers", None, None, False),
}

_TITLES = {
    "round": "Rounding",
    "tiles": "Tile coding",
    "fourier": "Fourier basis",
    "identity": "None: states are numbers",
    "epsilon_greedy": "ε-greedy",
    "visits": "By visits",
    "PCG64": "PCG64",
    "MT19937": "MT19937",
}
# Sentences that replace those of the config, which mention options that the page omits, or Python's names of them.
_SENTENCES = {
    "learning_rate": "α: the fraction of the error that an update corrects, in [0, 1]. With tile coding it is divided "
    "among the tilings, and may be up to 2. With a Fourier basis it is not divided, so it must be small.",
    "exploration": "The policy: a random action with probability ε, or the softmax of the values.",
    "max_episode_steps": "The time limit of an episode, in steps.",
    "initial_q": "The initial Q table: drawn uniformly from a range (low, high), or one number everywhere. With a "
    "Fourier basis these are weights, not values.",
    "discount": "γ: the discount factor, in [0, 1]: how much the value of the next state counts.",
    "learning_rate_schedule": "The schedule of α: constant, linear or exponential over the episodes, or α / n at the "
    "n-th visit of a state and action (by visits).",
    "min_learning_rate": "The lowest α, which is at most α itself. A linear schedule reaches it at the end of the run.",
    "traces": "The effect of a visit on the trace of a state and action: accumulating adds 1 to it, replacing sets it "
    "to 1, clearing also sets the traces of the state's other actions to 0. With a Fourier basis accumulating adds the "
    "cosines, and is the only choice.",
    "on_truncation": "The update at the time limit: bootstrap from the next state (correct), or terminate, as if the "
    "next state were terminal (a common mistake).",
    "epsilon_schedule": "The schedule of ε over the episodes.",
    "min_epsilon": "The lowest ε, which is at most ε itself. A linear schedule reaches it at the end of the run.",
    "discretizer": "How observations index the Q table: rounded to a grid, by bins of equal width, or by tile coding. "
    "A Fourier basis has no cells: the value is a sum of cosines, each with a weight.",
    "order": "n: the largest frequency of a cosine, in half waves along a component. There are (n + 1)ᵈ features of d "
    f"components if they are coupled, of which this page allows {MAX_FEATURES}.",
    "coupled": "Cosines of all components at once. Without them the value is a sum of functions of single components, "
    "as if these did not interact, with only d n + 1 features.",
    "low": "The lower limits of bins, tilings or a Fourier basis, one for each component of the observation. Values "
    "outside the limits fall into the outermost bin or tile; with a Fourier basis they are clipped to the limits.",
    "high": "The upper limits of bins, tilings or a Fourier basis, one for each component of the observation.",
    "scale_step_sizes": "Divides the α of a feature by the length of its frequency vector, so that fine waves are "
    "learned slowly.",
}
_SYMBOL = re.compile(r"(\w): ")


def title(word: str) -> str:
    """Returns the display name of a choice."""
    name = ALGORITHM_NAMES.get(word) or _TITLES.get(word) or word.replace("_", " ").capitalize()
    return name if name.startswith(("n-", "ε")) else name[:1].upper() + name[1:]


def setting(name: str, group: str) -> dict[str, Any]:
    """Returns the description of a setting for the page."""
    text = _SENTENCES.get(name) or explanations().get(name, "")
    symbol = _SYMBOL.match(text)
    sentence = text[symbol.end() :] if symbol else text
    choices = OFFERED.get(name)
    kind, low, high, log = ("choice", None, None, False) if choices else _CONTROLS[name]
    option = OPTIONS.get(name)
    known = OFFERED[option.choice].__contains__ if option else None
    return {
        "symbol": symbol[1] if symbol else None,
        "group": group,
        "sentence": sentence[:1].upper() + sentence[1:],
        "type": kind,
        "choices": choices and [{"value": word, "title": title(word)} for word in choices],
        "default": default(name),
        "low": low,
        "high": high,
        "log": log,
        "applies": None if option is None else {"choice": option.choice, "values": [*filter(known, option.values)]},
    }


def is_offered(name: str) -> bool:
    """Returns whether the page shows a setting, which must apply to some choice that the page offers."""
    if name not in OFFERED and name not in _CONTROLS:
        return False
    option = OPTIONS.get(name)
    return option is None or not set(option.values).isdisjoint(OFFERED[option.choice])


def settings() -> dict[str, dict[str, Any]]:
    """Returns every setting of the page by name; the groups are in the config's order."""
    grouped = groups(name for name in DEFAULTS if is_offered(name))
    return {name: setting(name, group) for group, names in grouped.items() for name in names}


def implied() -> dict[str, dict[str, Any]]:
    """Returns the settings that come with each discretizer of weighted features, and are set aside with it."""
    options = {name: value for name, value in DEFAULTS_OF_WEIGHTED.items() if is_offered(name)}
    return {
        name: {**found, **options}
        for name in OFFERED["discretizer"]
        if (found := weighted_defaults({"discretizer": name}))
    }


def _with_option(name: str) -> dict[str, Any]:
    """Returns a choice with which an option applies."""
    return {OPTIONS[name].choice: OPTIONS[name].values[0]} if name in OPTIONS else {}


def rules() -> list[dict[str, Any]]:
    """Returns the pairs of choices that exclude each other."""
    return [
        {"setting": name, "value": value, "unless": {other: chosen}}
        for name in ("terminal_update", "learning_rate_schedule", "traces", "algorithm")
        for value in OFFERED[name]
        for other in ("algorithm", "discretizer")
        if other != name
        for chosen in OFFERED[other]
        # An option is left out where it does not apply.
        if not (name in OPTIONS and other == OPTIONS[name].choice)
        if mismatch(name, value, {**DEFAULTS, **_with_option(name), other: chosen})
    ]
