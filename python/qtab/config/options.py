"""Options that belong to a choice: the default of each, once, and the refusal of those that belong to another."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Option:
    """A field of the config that means something for some values of another field only."""

    choice: str
    """The field that decides whether it has a meaning …"""
    values: tuple[str, ...]
    """… and the values for which it has."""
    default: Any
    """What stands for None, which means "not given"."""


_TRACES = ("sarsa_lambda", "watkins_q_lambda")
_FALLING = ("linear", "exponential")

# A choice stands before the options that belong to it.
OPTIONS: Mapping[str, Option] = {
    "trace_decay": Option("algorithm", (*_TRACES, "true_online_sarsa_lambda"), 0.9),
    "traces": Option("algorithm", _TRACES, "replacing"),
    "trace_cutoff": Option("algorithm", (*_TRACES, "true_online_sarsa_lambda"), 0.0),
    "n_steps": Option("algorithm", ("n_step_sarsa",), 4),
    "planning_steps": Option("algorithm", ("dyna_q", "dyna_q_plus"), 10),
    "time_weight": Option("algorithm", ("dyna_q_plus",), 1e-3),
    "min_learning_rate": Option("learning_rate_schedule", (*_FALLING, "visits"), 0.0),
    "learning_rate_decay": Option("learning_rate_schedule", ("exponential",), 0.999),
    "learning_rate_warm_up": Option("learning_rate_schedule", _FALLING, 0),
    "epsilon": Option("exploration", ("epsilon_greedy",), 0.8),
    "epsilon_schedule": Option("exploration", ("epsilon_greedy",), "linear"),
    "ties": Option("exploration", ("epsilon_greedy",), "first"),
    "min_epsilon": Option("epsilon_schedule", _FALLING, 0.0),
    "epsilon_decay": Option("epsilon_schedule", ("exponential",), 0.999),
    "epsilon_warm_up": Option("epsilon_schedule", _FALLING, 0),
    "temperature": Option("exploration", ("softmax",), 1.0),
    "scale": Option("discretizer", ("round",), None),
    "tilings": Option("discretizer", ("tiles",), 8),
    "tiles": Option("discretizer", ("tiles",), (8,)),
    "hashed_rows": Option("discretizer", ("tiles",), None),
    "bins": Option("discretizer", ("bins",), (10,)),
    "edges": Option("discretizer", ("edges",), None),
    "low": Option("discretizer", ("bins", "tiles"), None),
    "high": Option("discretizer", ("bins", "tiles"), None),
}

ONE_STEP = ("q_learning", "sarsa", "expected_sarsa", "double_q_learning", "dyna_q", "dyna_q_plus")
"""The algorithms that know the article's rule for terminal states, with a table."""
TABLES_ONLY = ("dyna_q", "dyna_q_plus")


def tables(algorithm: str) -> int:
    """Returns how many tables an algorithm learns."""
    return 2 if algorithm == "double_q_learning" else 1


def refuse_strangers(fields: Mapping[str, Any]) -> None:
    """Refuses options that do not belong to the choices made.

    Raises:
        ValueError: names the option, what it belongs to, and what was chosen.
    """
    for name in OPTIONS:
        if _given(fields[name]) and (reason := stranger(name, fields[name], fields)):
            raise ValueError(reason)
    for name in ("terminal_update", "learning_rate_schedule", "algorithm"):
        if reason := stranger(name, fields[name], fields):
            raise ValueError(reason)


def stranger(name: str, value: Any, fields: Mapping[str, Any]) -> str | None:
    """Returns why a value of an option does not go with the choices in ``fields``; None where it does."""
    if name in OPTIONS:
        option = OPTIONS[name]
        chosen = _chosen(option.choice, fields)
        if chosen not in option.values:
            return f"{name} belongs to {option.choice} {_listed(option.values)}, not to {chosen!r}, got {value!r}"
    if name == "terminal_update" and value == "assign":
        if fields["algorithm"] not in ONE_STEP:
            return f"terminal_update must be 'target' for algorithm {fields['algorithm']!r}, got 'assign'"
        if fields["discretizer"] == "tiles":
            return "terminal_update must be 'target' for discretizer 'tiles', got 'assign'"
    if (name, value) == ("learning_rate_schedule", "visits") and fields["algorithm"] == "true_online_sarsa_lambda":
        return "learning_rate_schedule must be another for algorithm 'true_online_sarsa_lambda', got 'visits'"
    if name == "algorithm" and value in TABLES_ONLY and fields["discretizer"] == "tiles":
        return f"algorithm must be one that needs no table for discretizer 'tiles', got {value!r}"
    return None


def defaults(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the values of the options that belong to the choices made and are not given."""
    filled: dict[str, Any] = {}
    for name, option in OPTIONS.items():
        if not _given(fields[name]) and _chosen(option.choice, {**fields, **filled}) in option.values:
            filled[name] = option.default
    return {name: value for name, value in filled.items() if value is not None}


def _given(value: Any) -> bool:
    return value is not None and value != ()


def _chosen(choice: str, fields: Mapping[str, Any]) -> Any:
    """The value of a choice, which may be an option itself, and not given."""
    value = fields[choice]
    if value is None:
        option = OPTIONS[choice]
        return option.default if _chosen(option.choice, fields) in option.values else None
    return value


def _listed(values: tuple[str, ...]) -> str:
    return " or ".join(map(repr, values))
