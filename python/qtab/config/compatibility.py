"""The compatibility of settings: options with the choices they apply to, and choices with each other."""

from collections.abc import Mapping, Sequence
from typing import Any

from qtab._utils.shown import shown
from qtab.config.choices import CHOICES
from qtab.config.discretizer import kind, uses_tiles
from qtab.config.options import (
    FIXED,
    NO_MASKED_TILES,
    OFF_BY_NONE,
    ONE_STEP,
    OPTIONS,
    PREFERENCES,
    TABLES_ONLY,
    WITH_PROBABILITIES,
    fixed_settings,
    is_set,
    listed,
)

_CHECKED = (
    *("terminal_update", "learning_rate_schedule", "discount", "algorithm", "exploration", "action_mask"),
    *("time_aware", "on_truncation"),
)
"""The settings, other than options, some of whose values exclude each other."""


def check_options(fields: Mapping[str, Any]) -> None:
    """Rejects options that do not apply to the choices made, and choices that are incompatible.

    Raises:
        ValueError: names the option, the choices it applies to, and the choice made.
    """
    for name in OPTIONS:
        if is_set(fields[name]) and (reason := mismatch(name, fields[name], fields)):
            raise ValueError(reason)
    for name in _CHECKED:
        if reason := mismatch(name, fields[name], fields):
            raise ValueError(reason)


def mismatch(name: str, value: Any, fields: Mapping[str, Any]) -> str | None:
    """Returns why a value of a setting is incompatible with the other ``fields``; None if it is compatible."""
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
        return "on_truncation must be 'terminate' for time_aware=True, got 'bootstrap'"
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


def turned_off(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the options that are off in a complete config, such as that of a run, each as None.

    A config with unset options is not complete, so any of its options may be unset.
    """
    if defaults(fields):
        return {}
    return {name: None for name in OFF_BY_NONE if fields[name] is None and not mismatch(name, None, fields)}


def applicable(fields: Mapping[str, Any], others: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings in ``fields`` that are compatible with the others, without options that do not apply."""
    kept = {name: value for name, value in fields.items() if not mismatch(name, value, others)}
    for name, option in OPTIONS.items():
        if option.choice in fields and option.choice not in kept:
            kept.pop(name, None)
    return kept


def other_choice(name: str, value: str, excluded: Sequence[str], where: str) -> str:
    """Returns the message for a value that is excluded by another choice."""
    possible = [word for word in CHOICES[name] if word not in excluded]
    return f"{name} must be {listed(possible)} {where}, got {shown(value)}"


def defaults(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the defaults of the options that apply and are not set."""
    complete, filled = dict(fields), {}
    for name, option in OPTIONS.items():
        if option.default is None or is_set(complete[name]):
            continue
        if _effective(option.choice, complete) in option.values:
            complete[name] = filled[name] = option.default
    return filled


def _effective(choice: str, fields: Mapping[str, Any]) -> Any:
    """The value of a choice, or its default if it is itself an option that applies and is not given."""
    if choice == "exploration" and fields["algorithm"] in PREFERENCES:
        return "softmax"
    value = kind(fields[choice]) if choice == "discretizer" else fields[choice]
    if value is None and choice in OPTIONS:
        option = OPTIONS[choice]
        return option.default if _effective(option.choice, fields) in option.values else None
    return value
