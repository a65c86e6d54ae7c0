"""The learning rate of a prediction: the schedules that a method supports, and the checks of their options."""

from collections.abc import Mapping
from typing import Any, get_args

from qtab._utils import checks
from qtab._utils.shown import listed, shown
from qtab.config import options as config
from qtab.config.choices import LearningRateSchedule
from qtab.config.implied import implied_schedule
from qtab.config.options import Option
from qtab.config.value_checks import Check

ONE_STEP_SIZE = (
    "td_lambda",
    "true_online_td_lambda",
    "off_policy_td",
    "off_policy_td_lambda",
    "gtd2",
    "tdc",
    "emphatic_td",
)
"""The methods that need a learning rate, which does not depend on visits: each update moves many weights together."""
AVERAGES_ONLY = ("importance_sampling", "batch_td")
"""The methods that average in each state, without a learning rate."""
LEAST_SQUARES = "lstd"
"""The method that solves equations, without a learning rate."""
LARGEST = 2.0
"""The largest learning rate, which is divided among the active features."""

OPTIONS = {name: config.OPTIONS[name] for name in ("min_learning_rate", "learning_rate_decay", "learning_rate_warm_up")}
"""The options of the schedules, with the defaults of :class:`qtab.Config`."""


def checked_learning_rate(method: str, episodes: int, given: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the checked learning rate, its schedule and the schedule's options; None for those that do not apply.

    Args:
        method: The method.
        episodes: The number of episodes.
        given: The settings, of which only these are read.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a value that is out of range, missing, or does not apply to the method or the schedule.
    """
    value, schedule = given["learning_rate"], given["learning_rate_schedule"]
    if schedule is not None:
        checks.choice("learning_rate_schedule", schedule, get_args(LearningRateSchedule))
    if method in (*AVERAGES_ONLY, LEAST_SQUARES):
        does = "averages" if method in AVERAGES_ONLY else "has no step size"
        for name in ("learning_rate", "learning_rate_schedule", *OPTIONS):
            if given[name] is not None:
                raise ValueError(f"{name} must be None for method {method!r}, which {does}, got {shown(given[name])}")
        return {}
    if method in ONE_STEP_SIZE and schedule == "visits":
        raise ValueError(
            f"learning_rate_schedule must be 'constant', 'linear' or 'exponential' for method {method!r}, got 'visits'"
        )
    if value is None and (method in ONE_STEP_SIZE or schedule not in (None, "visits")):
        whose = f"method {method!r}" if method in ONE_STEP_SIZE else f"learning_rate_schedule {schedule!r}"
        raise ValueError(f"learning_rate must be given for {whose}, got None")
    checked: dict[str, Any] = {}
    if value is not None:
        checked["learning_rate"] = value = checks.real("learning_rate", value, 0.0, LARGEST)
    if schedule is None and implied_schedule("learning_rate", given, "visits") == "linear":
        checked["learning_rate_schedule"] = schedule = "linear"
    kind = schedule or ("visits" if value is None else "constant")
    rate = 1.0 if value is None else value

    def check(name: str, option: Any) -> float | int:
        if name == "learning_rate_warm_up":
            return checks.integer(name, option, least=0, most=episodes - 1)
        return checks.real(name, option, 0.0, rate if name == "min_learning_rate" else 1.0)

    return checked | applied(kind, OPTIONS, given, check, fill=schedule is not None)


def applied(
    chosen: str, options: Mapping[str, Option], given: Mapping[str, Any], check: Check, *, fill: bool = True
) -> dict[str, Any]:
    """Returns the checked options that apply to a choice.

    Args:
        chosen: The value of the setting that decides which options apply.
        options: The options; one without a default must be given.
        given: The settings.
        check: A function that checks the value of an option, given its name.
        fill: Whether to fill in defaults for options that are not given.

    Raises:
        ValueError: if an option is missing, or given although it does not apply.
    """
    checked = {}
    for name, option in options.items():
        value = given[name]
        if chosen in option.values and (fill or value is not None):
            if value is None and option.default is None:
                raise ValueError(f"{name} must be given for {option.choice} {chosen!r}, got None")
            checked[name] = check(name, option.default if value is None else value)
        elif value is not None:
            applies = f"{option.choice} {listed(option.values)}"
            raise ValueError(f"{name} applies to {applies}, not to {chosen!r}, got {shown(value)}")
    return checked


def rate_settings(given: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the learning rate of checked settings as settings of :class:`qtab.Config`, with their defaults."""
    value = given["learning_rate"]
    is_constant = value is not None or given["method"] == LEAST_SQUARES
    return {
        "learning_rate": 1.0 if value is None else value,
        "learning_rate_schedule": given["learning_rate_schedule"] or ("constant" if is_constant else "visits"),
        "min_learning_rate": given["min_learning_rate"] or 0.0,
        "learning_rate_decay": given["learning_rate_decay"],
        "learning_rate_warm_up": given["learning_rate_warm_up"] or 0,
    }
