"""The check of the setting ``discretizer``, in which each key of the observation may have its own discretizer."""

from collections.abc import Mapping
from typing import Any

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab._utils.suggestions import did_you_mean
from qtab.config.choices import CHOICES
from qtab.config.options import OPTIONS, is_set, listed

_OPTIONS = [
    name for name, option in OPTIONS.items() if option.choice == "discretizer" and name not in ("shape", "max_rows")
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


def check_limits(low: tuple[float, ...] | None, high: tuple[float, ...] | None) -> None:
    """Checks that upper limits lie above lower ones, if both are given.

    Raises:
        ValueError: if one does not, or their numbers differ.
    """
    if low is None or high is None:
        return
    if len(low) != len(high):
        raise ValueError(f"high must hold as many numbers as low, got {shown(high)}")
    if not all(first < last for first, last in zip(low, high, strict=True)):
        raise ValueError(f"high must lie above low = {low!r}, got {shown(high)}")


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
