"""The implied schedules of rates that are requested without naming a schedule."""

from collections.abc import Mapping
from typing import Any

from qtab.config.compatibility import applicable
from qtab.config.options import OPTIONS, is_set

_SCHEDULES: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "learning_rate": ("learning_rate_schedule", ("min_learning_rate", "learning_rate_warm_up")),
    "epsilon": ("epsilon_schedule", ("min_epsilon", "epsilon_warm_up")),
}
"""For each rate that can fall, the setting that names its schedule, and the settings that apply only to a falling
rate."""


def implied_schedules(asked: Mapping[str, Any], fields: Mapping[str, Any]) -> dict[str, str]:
    """Returns the schedules of the rates that were requested without naming one; see :func:`implied_schedule`.

    Args:
        asked: The requested settings.
        fields: All settings.
    """
    found = {name: implied_schedule(rate, asked, fields[name]) for rate, (name, _) in _SCHEDULES.items()}
    return applicable({name: schedule for name, schedule in found.items() if schedule is not None}, fields)


def implied_schedule(rate: str, asked: Mapping[str, Any], otherwise: str | None) -> str | None:
    """Returns the schedule of a rate that was requested without naming one; None if nothing implies one.

    A rate given alone is constant. With a minimum or a warm-up it falls: linearly, unless the rate itself was not
    requested and already falls in another way.

    Args:
        rate: ``"learning_rate"`` or ``"epsilon"``.
        asked: The requested settings.
        otherwise: The schedule of the rate if none was requested.
    """
    name, falling = _SCHEDULES[rate]
    if is_set(asked.get(name)):
        return None
    falls = any(is_set(asked.get(option)) for option in falling)
    if is_set(asked.get(rate)):
        return "linear" if falls else "constant"
    return "linear" if falls and otherwise in (None, "constant") else None


def without_rates(start: Mapping[str, Any], asked: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings of a preset without the schedules of the requested rates.

    The schedule of a preset belongs to its rate: a requested rate does not fall because the preset's does.
    """
    replaced = tuple(rate for rate in _SCHEDULES if is_set(asked.get(rate)))
    return {name: value for name, value in start.items() if not any(_belongs(name, rate) for rate in replaced)}


def _belongs(name: str, rate: str) -> bool:
    return name == _SCHEDULES[rate][0] or (name in OPTIONS and OPTIONS[name].choice == _SCHEDULES[rate][0])
