"""The check of a whole config: each setting by itself, and settings that limit or exclude others."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from qtab._utils import checks
from qtab._utils.shown import did_you_mean, listed, shown
from qtab.config.choices import CHOICES, FUNCTION, MAPPING
from qtab.config.options import (
    DEFAULTS_OF_NORMALIZED,
    DEFAULTS_OF_WEIGHTED,
    FIXED,
    NO_MASKED_TILES,
    ONE_STEP,
    OPTIONS,
    PREFERENCES,
    SETTINGS,
    TABLES_ONLY,
    WEIGHTED,
    WITH_PROBABILITIES,
    fixed_settings,
    is_set,
)
from qtab.config.value_checks import check_limits, not_negative

_CHECKED = (
    *("terminal_update", "learning_rate_schedule", "discount", "algorithm", "exploration", "action_mask"),
    *("time_aware", "on_truncation", "count_bonus"),
)
"""The settings, other than options, some of whose values exclude each other."""


def mismatch(name: str, value: Any, fields: Mapping[str, Any]) -> str | None:
    """Returns why a value of a setting is incompatible with the other ``fields``; None if it is compatible."""
    if name in OPTIONS:
        option = OPTIONS[name]
        chosen = _effective(option.choice, fields)
        if chosen is None and option.choice in OPTIONS:  # the choice is itself an option that does not apply
            option = OPTIONS[option.choice]
            chosen = fields[option.choice]
        if chosen not in option.values:
            applies = f"{option.choice} {listed(option.values)}, not to {chosen!r}"
            return f"{name} applies to {applies}, got {shown(value)}{_instead(name, fields)}"
    algorithm = fields["algorithm"]
    with_tiles, with_weighted = uses_tiles(fields["discretizer"]), uses_weighted(fields["discretizer"])
    where = f"for discretizer {'tiles' if with_tiles else fields['discretizer']!r}"
    if (name, value) == ("terminal_update", "assign"):
        if algorithm not in ONE_STEP:
            return f"terminal_update must be 'target' for algorithm {algorithm!r}, got 'assign'"
        if with_tiles or with_weighted:
            return f"terminal_update must be 'target' {where}, got 'assign'"
    if name == "algorithm" and value in TABLES_ONLY and (with_tiles or with_weighted):
        others = other_choice(name, value, TABLES_ONLY, where)
        return f"{others}, which works with discretizer 'round', 'bins', 'edges' or 'identity'"
    if with_weighted and (reason := _mismatch_with_weighted(name, value, fields["discretizer"])):
        return reason
    by_episode = ("true_online_sarsa_lambda", *PREFERENCES)
    if (name, value) == ("learning_rate_schedule", "visits") and algorithm in by_episode:
        return other_choice(name, value, ("visits",), f"for algorithm {algorithm!r}")
    only_visits = algorithm == "off_policy_monte_carlo" and not with_weighted
    if name == "learning_rate_schedule" and value != "visits" and only_visits:
        return f"{name} must be 'visits' for algorithm {algorithm!r}, got {shown(value)}"
    if name in fixed_settings(algorithm) and value != (only := FIXED[algorithm].values[name]):
        wanted = f"{only:g}" if isinstance(only, float) else repr(only)
        return (
            f"{name} must be {wanted} for algorithm {algorithm!r}, which {FIXED[algorithm].reason}, got {shown(value)}"
        )
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


def _instead(name: str, fields: Mapping[str, Any]) -> str:
    """Returns the end of a message about an option: another that applies and also has this name; or nothing."""
    for other, option in OPTIONS.items():
        if name in option.other_names.split() and _effective(option.choice, fields) in option.values:
            return f" (did you mean {other!r}?)"
    return ""


def _mismatch_with_weighted(name: str, value: Any, discretizer: str) -> str | None:
    """Returns why a value of a setting has no meaning, or is not supported, with weighted features."""
    where = f"for discretizer {discretizer!r}"
    if (name, value) in (("learning_rate_schedule", "visits"), ("exploration", "ucb")):
        return other_choice(name, value, (value,), f"{where}, whose features have no visits to count")
    if name == "traces" and value in ("replacing", "clearing"):
        not_1 = discretizer != "coarse"
        reason = "the others set traces to 1, and its features are not 1" if not_1 else "the others are not implemented"
        return (
            f"traces must be 'accumulating' {where}, because {reason}, got {shown(value)}; algorithm "
            "'true_online_sarsa_lambda' has dutch traces"
        )
    if name == "action_mask" and value is not False:
        return f"action_mask must be False {where}, got {shown(value)}"
    if name == "count_bonus" and value != 0:
        return f"count_bonus must be 0 {where}, whose states cannot be counted, got {shown(value)}"
    if name == "time_aware" and value:
        return f"time_aware must be False {where}, got True; gymnasium.wrappers.TimeAwareObservation adds the time"
    return None


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
            special: Mapping[str, Any] = {}
            if uses_weighted(complete["discretizer"]):
                special = DEFAULTS_OF_NORMALIZED if complete["normalized"] else DEFAULTS_OF_WEIGHTED
            complete[name] = filled[name] = special.get(name, option.default)
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


def kind(discretizer: Any) -> str:
    """Returns the name of a discretizer, or ``"function"`` or ``"mapping"``."""
    if isinstance(discretizer, Mapping):
        return MAPPING
    return FUNCTION if callable(discretizer) else str(discretizer)


def uses_tiles(discretizer: Any) -> bool:
    """Whether a discretizer is, or contains, tile coding, so that no state has a row of its own."""
    if isinstance(discretizer, Mapping):
        names = (one.get("discretizer") if isinstance(one, Mapping) else one for one in discretizer.values())
        return any(isinstance(name, str) and name == "tiles" for name in names)
    return bool(discretizer == "tiles")


def uses_weighted(discretizer: Any) -> bool:
    """Whether the features of a discretizer are weighted."""
    return isinstance(discretizer, str) and discretizer in WEIGHTED


_OPTIONS = [
    name
    for name, option in OPTIONS.items()
    if option.choice == "discretizer" and name not in ("shape", "max_rows") and not set(option.values) <= {*WEIGHTED}
]
"""The options that the discretizer of a key can have."""


def checked_discretizer(name: str, value: Any) -> Any:
    """Returns the checked setting: a mapping from each key to a mapping with the name and all options that apply.

    Args:
        name: The name of the setting.
        value: Its value: a name, a function, or a mapping from keys to names or to mappings.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for an unknown name, or an option that does not fit.
    """
    if isinstance(value, Mapping):
        if not value:
            raise ValueError(f"{name} must name a discretizer for at least one key of the observation, got {{}}")
        return {_key(name, key): _of_key(f"{name}[{key!r}]", given) for key, given in value.items()}
    if callable(value):
        return value
    return checks.choice(name, value, CHOICES[name])


def _key(name: str, key: Any) -> str:
    if isinstance(key, bool) or not isinstance(key, str | int):
        raise TypeError(f"{name} must have the keys of the observation, strings or integers, got {shown(key)}")
    return str(key)


def _of_key(name: str, given: Any) -> dict[str, Any]:
    options = {"discretizer": given} if isinstance(given, str) else given
    if not isinstance(options, Mapping) or not isinstance(options.get("discretizer"), str):
        raise TypeError(
            f"{name} must be a name, or a mapping of 'discretizer' to a name and of options, got {shown(given)}"
        )
    chosen = checks.choice(name, options["discretizer"], CHOICES["discretizer"])
    if chosen in WEIGHTED:
        others = [word for word in CHOICES["discretizer"] if word not in WEIGHTED]
        raise ValueError(f"{name} must be {listed(others)}, because {chosen!r} has no rows for a key, got {chosen!r}")
    complete: dict[str, Any] = {"discretizer": chosen}
    for option, value in options.items():
        if option == "discretizer" or not is_set(value):
            continue
        if option not in _OPTIONS:
            raise ValueError(f"{name} has an unknown option {option!r}{did_you_mean(str(option), _OPTIONS)}")
        applies_to = OPTIONS[option].values
        if chosen not in applies_to:
            raise ValueError(f"{name}: {option} applies to {listed(applies_to)}, not to {chosen!r}, got {shown(value)}")
        try:
            complete[option] = OPTIONS[option].check(option, value)
        except (TypeError, ValueError) as error:
            raise type(error)(f"{name}: {error}") from None
    try:
        check_limits(complete.get("low"), complete.get("high"))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    defaults = {option: OPTIONS[option].default for option in _OPTIONS if chosen in OPTIONS[option].values}
    return {option: value for option, value in {**defaults, **complete}.items() if is_set(value)}


LARGEST_MT19937_SEED = 2**32 - 1


def validated(fields: Mapping[str, Any], standard: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the checked fields of a config. None stays None if it means "not given".

    Args:
        fields: The fields.
        standard: The defaults of the fields, which are valid.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a value that is out of range, or incompatible with another.
    """
    checked = dict(fields)
    if fields["seed"] is not None and fields["bit_generator"] == "MT19937":
        checks.integer("seed", fields["seed"], least=0, most=LARGEST_MT19937_SEED)
    for name, setting in SETTINGS.items():
        value = fields[name]
        is_default = value is standard[name] and not isinstance(value, dict)  # of which the config gets its own
        if not is_default and (value is not None or not setting.may_be_none):
            try:
                checked[name] = setting.check(name, value)
            except (TypeError, ValueError) as error:
                if instead := _instead(name, fields):
                    raise type(error)(f"{error}{instead}") from None
                raise
    checked["discretizer"] = checked_discretizer("discretizer", fields["discretizer"])
    for name in (*OPTIONS, *_CHECKED):
        if (name in _CHECKED or is_set(checked[name])) and (reason := mismatch(name, checked[name], checked)):
            raise ValueError(reason)
    with_tiles = uses_tiles(checked["discretizer"])
    without_cells = with_tiles or uses_weighted(checked["discretizer"])
    if without_cells and isinstance(checked["initial_q"], np.ndarray) and np.isneginf(checked["initial_q"]).any():
        given = "tiles" if with_tiles else checked["discretizer"]
        without = ("tiles", *WEIGHTED)
        raise ValueError(other_choice("discretizer", given, without, "for an initial_q that contains -inf"))
    most_rate = 2 if without_cells else 1
    if checked["algorithm"] in PREFERENCES:
        not_negative("learning_rate", checked["learning_rate"])
    else:
        checks.real("learning_rate", checked["learning_rate"], 0, most_rate)
    if checked["value_learning_rate"] is not None:
        checks.real("value_learning_rate", checked["value_learning_rate"], 0, most_rate)
    for name, limit in (("min_epsilon", "epsilon"), ("min_learning_rate", "learning_rate")):
        most = OPTIONS["epsilon"].default if checked[limit] is None else checked[limit]
        if checked[name] is not None and checked[name] > most:
            raise ValueError(f"{name} must lie in [0, {limit} = {most:g}], got {shown(checked[name])}")
    for name in ("epsilon_warm_up", "learning_rate_warm_up"):
        if checked[name] is not None and checked[name] >= checked["episodes"]:
            raise ValueError(f"{name} must be less than episodes = {checked['episodes']}, got {shown(checked[name])}")
    check_limits(checked["low"], checked["high"])
    return checked
