"""The data that plots accept: a run, many runs, a sweep, arrays, or several of these by name."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from qtab._utils import arrays, checks
from qtab.envs.metadata.goals import threshold_of
from qtab.plots.parts.labels import joined
from qtab.results.run import Run
from qtab.results.runs import Runs
from qtab.results.summary import FINAL_EPISODES
from qtab.sweeps.environments import sweep_threshold
from qtab.sweeps.results import Sweep

BEST_SETTINGS = 8
"""The largest number of settings of a sweep in a plot; of more, it shows those with the best mean final return."""

Kind = Literal["curves", "final returns"]


@dataclass(frozen=True)
class Entry:
    """The data of one line or histogram of a plot."""

    label: str
    """Its name in the legend; empty if there is only one."""
    values: NDArray[np.float64]
    """(runs, points) for learning curves, else (runs,)."""
    unit: int = 1
    """The number of episodes that a point of a learning curve averages; more than 1 for a sweep."""
    threshold: float | None = None
    """The return at which Gymnasium considers its environment solved; None if none applies."""
    color_key: Any = None
    """The algorithm or the number that determines the color."""


def entries(name: str, data: Any, kind: Kind, settings: Sequence[int] | None = None) -> tuple[list[Entry], str]:
    """Returns the entries to draw, and a note if some settings of a sweep are left out.

    Args:
        name: The name of the argument.
        data: Its value: a Run, Runs, a Sweep, an array, or a mapping of names to any of these.
        kind: Whether to return the learning curves or the final returns.
        settings: The indices of the settings of a sweep to draw; None means all, or the best eight.

    Raises:
        TypeError: for data of another type, or that are not numbers.
        ValueError: for empty data, a wrong shape or numbers that are not finite.
    """
    named = isinstance(data, Mapping)
    if named and not data:
        raise ValueError(f"{name} must name at least one setting, got {data!r}")
    items = [(f"{name}[{key!r}]", key, value) for key, value in data.items()] if named else [(name, "", data)]
    if settings is not None and not any(isinstance(value, Sweep) for _, _, value in items):
        raise ValueError(f"settings must be None where {name} has no sweep, got {settings!r}")
    found: list[Entry] = []
    notes = []
    for argument, key, value in items:
        if isinstance(value, Sweep):
            chosen, note = _chosen_settings(argument, value, settings)
            found += _of_sweep(str(key), value, kind, chosen)
            notes += [note] if note else []
        else:
            found.append(_entry(argument, key, value, kind))
    if not found:
        raise ValueError(f"{name} must have runs of at least one block of episodes, which sweep(block=) sets, got none")
    return found, "; ".join(notes)


def only_threshold(drawn: Sequence[Entry]) -> float | None:
    """Returns the threshold of all entries, or None if they have different or unknown ones."""
    thresholds = {entry.threshold for entry in drawn}
    return thresholds.pop() if len(thresholds) == 1 else None


def color_keys(drawn: Sequence[Entry]) -> list[Any]:
    """Returns the keys of the colors: the algorithms or numbers if all entries have different ones, or the labels.

    A label that is the name of an algorithm determines the color of an array.
    """
    keys = [entry.color_key for entry in drawn]
    return keys if None not in keys and len(set(keys)) == len(keys) else [entry.label for entry in drawn]


def final_returns(name: str, value: Any) -> NDArray[np.float64]:
    """Returns (runs,): the final returns of a Run or of Runs, or the values of an array.

    Raises:
        TypeError: for another type.
        ValueError: for empty data, another shape or numbers that are not finite.
    """
    if isinstance(value, Runs):
        _require_episodes(name, value)
        value = value.final_returns()
    elif isinstance(value, Run):
        _require_episodes(name, value)
        value = [value.episode_returns[-FINAL_EPISODES:].mean()]
    return arrays.sample(name, value)


def _entry(argument: str, key: Any, value: Any, kind: Kind) -> Entry:
    is_result = isinstance(value, Run | Runs)
    if not is_result and (isinstance(value, str | bytes | Mapping) or not hasattr(value, "__len__")):
        raise TypeError(
            f"{argument} must be a Run, Runs, a Sweep or an array of returns, got {arrays.shortened(value)}"
        )
    if kind == "final returns":
        values = final_returns(argument, value)
    elif is_result:
        _require_episodes(argument, value)
        values = np.atleast_2d(value.episode_returns)
    else:
        values = arrays.curves(argument, value)
    threshold = threshold_of(value.config) if is_result else None
    color_key = value.config.algorithm if is_result else key if isinstance(key, int | float) else None
    return Entry(str(key), values, 1, threshold, color_key)


def _require_episodes(argument: str, value: Run | Runs) -> None:
    if not value.episode_returns.size:
        raise ValueError(f"{argument} must have at least one finished episode, got {value!r}")


def _chosen_settings(argument: str, sweep: Sweep, settings: Any) -> tuple[list[int], str]:
    """Returns the settings of a sweep to draw, and a note if these are not all of those that have runs."""
    present = [setting for setting in range(len(sweep.settings)) if len(sweep.values("seed", setting))]
    if settings is not None:
        if isinstance(settings, str) or not hasattr(settings, "__iter__"):
            raise TypeError(f"settings must be a list of indices of settings, got {settings!r}")
        chosen = [checks.integer("settings", index, 0, len(sweep.settings) - 1) for index in settings]
        without = [index for index in chosen if index not in present]
        if not chosen or without:
            got = f"setting {without[0]}, all of whose runs failed" if without else "none"
            raise ValueError(f"settings must name at least one setting with a run that succeeded, got {got}")
        return list(dict.fromkeys(chosen)), ""
    if not present:
        raise ValueError(f"{argument} must have at least one run that succeeded, got {sweep!r}")
    if len(present) <= BEST_SETTINGS:
        return present, ""
    means = {setting: float(sweep.values("final_return", setting).mean()) for setting in present}
    best = sorted(present, key=lambda setting: -means[setting])[:BEST_SETTINGS]
    return best, f"the best {BEST_SETTINGS} of {len(present)} settings by mean final return"


def _of_sweep(key: str, sweep: Sweep, kind: Kind, chosen: list[int]) -> Iterator[Entry]:
    varied = [name for name in sweep.settings[0] if len({repr(setting[name]) for setting in sweep.settings}) > 1]
    for setting in chosen:
        values = {name: sweep.settings[setting][name] for name in varied}
        text = ", ".join(f"{name} = {short(value)}" for name, value in values.items())
        curves = sweep.curves(setting) if kind == "curves" else sweep.values("final_return", setting)
        if curves.size:
            color_key = next(iter(values.values())) if len(varied) == 1 else None
            is_key = isinstance(color_key, str | int | float) and not key
            yield Entry(
                joined(key, text, separator=": "),
                arrays.numbers("the sweep's returns", curves),
                sweep.block,
                sweep_threshold(sweep, setting),
                color_key if is_key else None,
            )


def short(value: Any) -> str:
    """Returns a value of a setting as text, numbers rounded to four digits."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
