"""Settings that apply only beside certain choices: the default of each, and the check that it applies."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from qtab._utils.shown import shown
from qtab.config.choices import CHOICES
from qtab.config.discretizer import FUNCTION, MAPPING, kind, uses_tiles


@dataclass(frozen=True)
class Option:
    """A setting that applies only for some values of another setting, such as the trace decay of Sarsa(λ)."""

    choice: str
    """The other setting."""
    values: tuple[str, ...]
    """The values of the other setting for which this one applies."""
    default: Any
    """The default where it applies. None: it has none, or is found from the observation space."""


@dataclass(frozen=True)
class Fixed:
    """Settings that have a single value for an algorithm, which would ignore any other."""

    values: Mapping[str, Any]
    """The value of each of these settings."""
    reason: str
    """Why: a message says "for algorithm ..., which" before it."""


_WITH_TRACES = ("sarsa_lambda", "watkins_q_lambda")
_WITH_TARGET_POLICY = ("n_step_tree_backup", "n_step_q_sigma")
_FALLING = ("linear", "exponential")
WITH_STATE_VALUES = ("reinforce_with_baseline", "actor_critic", "actor_critic_lambda")
"""The algorithms that learn state values beside a policy: a second table, with the value of a row in every column."""
PREFERENCES = ("gradient_bandit", "reinforce", *WITH_STATE_VALUES)
"""The algorithms whose table holds preferences, of which the policy is the softmax, instead of action values."""

WITH_PROBABILITIES = ("off_policy_monte_carlo", *_WITH_TARGET_POLICY)
"""The algorithms that learn from the probabilities of the actions."""
AVERAGE_REWARD = ("differential_sarsa", "differential_q_learning")
"""The algorithms that learn the average reward, without a discount."""
MONTE_CARLO = ("monte_carlo", "monte_carlo_es", "off_policy_monte_carlo")
"""The algorithms that learn from the returns of whole episodes."""

_RETURNS_ALONE = Fixed({"on_truncation": "terminate"}, "learns from the rewards of an episode alone")
FIXED: Mapping[str, Fixed] = {
    **dict.fromkeys(AVERAGE_REWARD, Fixed({"discount": 1.0}, "learns the average reward")),
    "gradient_bandit": Fixed({"discount": 0.0, "on_truncation": "terminate"}, "learns from the next reward alone"),
    "reinforce": _RETURNS_ALONE,
    "reinforce_with_baseline": _RETURNS_ALONE,
}
"""The algorithms for which some settings are fixed."""

# A choice comes before the options that depend on it.
OPTIONS: Mapping[str, Option] = {
    "trace_decay": Option("algorithm", (*_WITH_TRACES, "true_online_sarsa_lambda", "actor_critic_lambda"), 0.9),
    "traces": Option("algorithm", _WITH_TRACES, "replacing"),
    "trace_cutoff": Option("algorithm", (*_WITH_TRACES, "true_online_sarsa_lambda"), 0.0),
    "n_steps": Option("algorithm", ("n_step_sarsa", *_WITH_TARGET_POLICY), 4),
    "sigma": Option("algorithm", ("n_step_q_sigma",), 0.5),
    "target_policy": Option("algorithm", _WITH_TARGET_POLICY, "greedy"),
    "planning_steps": Option("algorithm", ("dyna_q", "dyna_q_plus", "prioritized_sweeping"), 10),
    "time_weight": Option("algorithm", ("dyna_q_plus",), 1e-3),
    "model": Option("algorithm", ("dyna_q",), "deterministic"),
    "priority_threshold": Option("algorithm", ("prioritized_sweeping",), 1e-4),
    "reward_learning_rate": Option("algorithm", AVERAGE_REWARD, 0.01),
    "baseline": Option("algorithm", ("gradient_bandit",), True),
    "value_learning_rate": Option("algorithm", WITH_STATE_VALUES, 0.1),
    "min_learning_rate": Option("learning_rate_schedule", (*_FALLING, "visits"), 0.0),
    "learning_rate_decay": Option("learning_rate_schedule", ("exponential",), 0.999),
    "learning_rate_warm_up": Option("learning_rate_schedule", _FALLING, 0),
    "epsilon": Option("exploration", ("epsilon_greedy",), 0.8),
    "epsilon_schedule": Option("exploration", ("epsilon_greedy",), "linear"),
    "ties": Option("exploration", ("epsilon_greedy", "ucb"), "first"),
    "min_epsilon": Option("epsilon_schedule", _FALLING, 0.0),
    "epsilon_decay": Option("epsilon_schedule", ("exponential",), 0.999),
    "epsilon_warm_up": Option("epsilon_schedule", _FALLING, 0),
    "temperature": Option("exploration", ("softmax",), 1.0),
    "confidence": Option("exploration", ("ucb",), 2.0),
    "shape": Option("discretizer", (FUNCTION,), None),
    "max_rows": Option("discretizer", ("round", "bins", "edges", "identity", FUNCTION, MAPPING), None),
    "scale": Option("discretizer", ("round",), None),
    "tilings": Option("discretizer", ("tiles",), 8),
    "tiles": Option("discretizer", ("tiles",), (8,)),
    "hashed_rows": Option("discretizer", ("tiles",), None),
    "bins": Option("discretizer", ("bins",), (10,)),
    "edges": Option("discretizer", ("edges",), None),
    "low": Option("discretizer", ("bins", "tiles"), None),
    "high": Option("discretizer", ("bins", "tiles"), None),
}

OFF_BY_NONE = ("hashed_rows", "max_rows")
"""The options for which None is a real value, not just "not set"."""

ONE_STEP = (
    "q_learning",
    "sarsa",
    "expected_sarsa",
    "double_q_learning",
    "dyna_q",
    "dyna_q_plus",
    "prioritized_sweeping",
)
"""The algorithms that can assign a value at a terminal state, as the article does, if they learn a table."""
TABLES_ONLY = ("dyna_q", "dyna_q_plus", *MONTE_CARLO, "prioritized_sweeping", "gradient_bandit")
"""The algorithms that do not work with tile coding."""
NO_MASKED_TILES = (*PREFERENCES, *_WITH_TARGET_POLICY)
"""The algorithms that do not work with action masks and tile coding together.

They update states after the next one is seen, and only the mask of the last one is known.
"""


_CHECKED = (
    *("terminal_update", "learning_rate_schedule", "discount", "algorithm", "exploration", "action_mask"),
    *("time_aware", "on_truncation"),
)
"""The settings, no options, of which some values exclude each other."""


def n_tables(algorithm: str) -> int:
    """Returns how many tables an algorithm learns."""
    return 2 if algorithm in ("double_q_learning", *WITH_STATE_VALUES) else 1


def check_options(fields: Mapping[str, Any]) -> None:
    """Refuses options that do not apply to the choices made, and choices that do not go together.

    Raises:
        ValueError: names the option, what it applies to, and what was chosen.
    """
    for name in OPTIONS:
        if is_set(fields[name]) and (reason := mismatch(name, fields[name], fields)):
            raise ValueError(reason)
    for name in _CHECKED:
        if reason := mismatch(name, fields[name], fields):
            raise ValueError(reason)


def mismatch(name: str, value: Any, fields: Mapping[str, Any]) -> str | None:
    """Returns why a value of a setting does not go with the other settings, ``fields``; None if it does."""
    if name in OPTIONS:
        option = OPTIONS[name]
        chosen = _effective(option.choice, fields)
        if chosen is None and option.choice in OPTIONS:  # the choice is itself an option that does not apply
            option = OPTIONS[option.choice]
            chosen = fields[option.choice]
        if chosen not in option.values:
            return f"{name} applies to {option.choice} {listed(option.values)}, not to {chosen!r}, got {shown(value)}"
    algorithm = fields["algorithm"]
    with_tiles = uses_tiles(fields["discretizer"])
    if (name, value) == ("terminal_update", "assign"):
        if algorithm not in ONE_STEP:
            return f"terminal_update must be 'target' for algorithm {algorithm!r}, got 'assign'"
        if with_tiles:
            return "terminal_update must be 'target' for discretizer 'tiles', got 'assign'"
    by_episode = ("true_online_sarsa_lambda", *PREFERENCES)
    if (name, value) == ("learning_rate_schedule", "visits") and algorithm in by_episode:
        return other_choice(name, value, ("visits",), f"for algorithm {algorithm!r}")
    if name == "learning_rate_schedule" and value != "visits" and algorithm == "off_policy_monte_carlo":
        return f"{name} must be 'visits' for algorithm {algorithm!r}, got {shown(value)}"
    if name in fixed_settings(algorithm) and value != (only := FIXED[algorithm].values[name]):
        wanted = f"{only:g}" if isinstance(only, float) else repr(only)
        return (
            f"{name} must be {wanted} for algorithm {algorithm!r}, which {FIXED[algorithm].reason}, got {shown(value)}"
        )
    if name == "algorithm" and value in TABLES_ONLY and with_tiles:
        others = other_choice(name, value, TABLES_ONLY, "for discretizer 'tiles'")
        return f"{others}, which works with discretizer 'round', 'bins', 'edges' or 'identity'"
    if name == "exploration" and algorithm in PREFERENCES and value != "softmax":
        return f"exploration must be 'softmax' for algorithm {algorithm!r}, got {shown(value)}"
    if name == "action_mask" and value is not False and algorithm in NO_MASKED_TILES and with_tiles:
        return f"action_mask must be False for algorithm {algorithm!r} with discretizer 'tiles', got {shown(value)}"
    if (name, value) == ("on_truncation", "bootstrap") and fields["time_aware"]:
        return "on_truncation must be 'terminate' for time_aware=True, whose last step nothing follows, got 'bootstrap'"
    if name == "time_aware" and value and with_tiles:
        return (
            "time_aware must be False for discretizer 'tiles', which has no cells, got True; "
            "gymnasium.wrappers.TimeAwareObservation makes the time a component that it can tile"
        )
    if name == "time_aware" and value and fields["max_rows"] is not None:
        return f"time_aware must be False with max_rows, got True and max_rows={fields['max_rows']}"
    if (name, value) == ("exploration", "ucb") and with_tiles:
        return other_choice(name, value, ("ucb",), "for discretizer 'tiles'")
    if (name, value) == ("exploration", "ucb") and algorithm in WITH_PROBABILITIES:
        return other_choice(name, value, ("ucb",), f"for algorithm {algorithm!r}")
    return None


def fixed_settings(algorithm: Any) -> Mapping[str, Any]:
    """Returns the settings that have a single value for an algorithm; none if ``algorithm`` is not the name of one."""
    return FIXED[algorithm].values if isinstance(algorithm, str) and algorithm in FIXED else {}


def freed_settings(before: Any, now: Any) -> set[str]:
    """Returns the names of the settings that were fixed for the algorithm before, and are not for the one now."""
    return fixed_settings(before).keys() - fixed_settings(now).keys()


def turned_off(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the options that a complete config, such as that of a run, has off, each with its None.

    A config in which options are still open is not complete, and nothing says that another one is not open as well.
    """
    if defaults(fields):
        return {}
    return {name: None for name in OFF_BY_NONE if fields[name] is None and not mismatch(name, None, fields)}


def applicable(fields: Mapping[str, Any], others: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings in ``fields`` that fit the other settings, without the options of choices that do not."""
    kept = {name: value for name, value in fields.items() if not mismatch(name, value, others)}
    for name, option in OPTIONS.items():
        if option.choice in fields and option.choice not in kept:
            kept.pop(name, None)
    return kept


def other_choice(name: str, value: str, excluded: Sequence[str], where: str) -> str:
    """Returns the message for a choice that is excluded where something else was chosen."""
    possible = [word for word in CHOICES[name] if word not in excluded]
    return f"{name} must be {listed(possible)} {where}, got {shown(value)}"


def listed(words: Sequence[str]) -> str:
    """Returns words as English lists them: ``'a', 'b' or 'c'``."""
    *others, last = map(repr, words)
    return f"{', '.join(others)} or {last}" if others else last


def defaults(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the defaults of the options that apply and are not set."""
    complete, filled = dict(fields), {}
    for name, option in OPTIONS.items():
        if option.default is None or is_set(complete[name]):
            continue
        if _effective(option.choice, complete) in option.values:
            complete[name] = filled[name] = option.default
    return filled


def is_set(value: Any) -> bool:
    """Returns whether a setting has a value: None, and an empty scale, mean "not given"."""
    return value is not None and not (isinstance(value, tuple) and not value)


def _effective(choice: str, fields: Mapping[str, Any]) -> Any:
    """The value of a choice, or its default if it is itself an option that applies and is not given."""
    if choice == "exploration" and fields["algorithm"] in PREFERENCES:
        return "softmax"
    value = kind(fields[choice]) if choice == "discretizer" else fields[choice]
    if value is None and choice in OPTIONS:
        option = OPTIONS[choice]
        return option.default if _effective(option.choice, fields) in option.values else None
    return value
