"""Checks of functions that are not learners: several calls, whose results are compared."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np

from qtab._utils.fields import with_fields
from qtab.exercises.exercise import Solution, parameters
from qtab.exercises.guard import guarded
from qtab.exercises.record import Event, Misuse, Record, equal
from qtab.exercises.recording_env import RANDOM_NUMBERS

Arguments = Mapping[str, Any]
LINE = 72
"""The maximum number of characters in a line of an array, so that a report need not break it."""


@with_fields
@dataclass(frozen=True)
class FunctionCheck:
    """A check of an exercise: calls a function several times, and compares what it returns, changes and draws."""

    title: str
    """The settings, in a few words."""
    model: Solution
    """The function of the reference, as in the exercise. The names of its parameters are those of the arguments."""
    calls: Callable[[], Iterable[Arguments]]
    """Returns the arguments of each call by name, always the same ones. Calls may share arrays."""
    returns: Sequence[tuple[str, Any]] = ()
    """The name and an example of each returned value: an array of the right shape and dtype, an int or a float."""
    changes: Sequence[str] = ()
    """The names of the arguments, all arrays, that the function changes. It must not change any others."""

    def run(self, function: Solution, record: Record, seconds: float) -> None:
        """Calls a function, and records what it returns, changes and draws.

        :meta private:
        """
        names = parameters(self.model)
        for number, given in enumerate(self.calls()):
            place, about = f"call {number}", _in_words(given)
            kept = {name: deepcopy(given[name]) for name in names if name not in (*self.changes, "rng")}
            result = guarded(function, {name: given[name] for name in names}, record, seconds)
            for name, before in kept.items():
                if not _unchanged(before, given[name]):
                    raise Misuse(f"{place}: it changes its argument {name}: work on a copy, {name}.copy()")
            for name, value in self._returned(place, result):
                record.events.append(Event(place, name, value, about))
            for name in self.changes:
                record.events.append(Event(place, name, given[name].copy(), about))
            if "rng" in given:
                state = deepcopy(given["rng"].bit_generator.state)
                record.events.append(Event(place, RANDOM_NUMBERS, state, about))

    def _returned(self, place: str, result: Any) -> Iterable[tuple[str, Any]]:
        """Yields each returned value with its name.

        Raises:
            Misuse: for a value of the wrong type or shape.
        """
        if not self.returns:
            return
        parts = [result] if len(self.returns) == 1 else result
        if len(self.returns) > 1 and not (isinstance(result, tuple) and len(result) == len(self.returns)):
            wanted = ", ".join(name for name, _ in self.returns)
            raise Misuse(f"{place}: it must return {wanted}, got {_kind(result)}")
        for (name, example), value in zip(self.returns, parts, strict=True):
            if isinstance(example, int):
                if not isinstance(value, int | np.integer) or isinstance(value, bool):
                    raise Misuse(f"{place}: {name} must be an integer, got {_kind(value)}")
                yield name, int(value)
            elif isinstance(example, float):
                if not isinstance(value, Real) or isinstance(value, bool):
                    raise Misuse(f"{place}: {name} must be a number, got {_kind(value)}")
                yield name, np.asarray(value, dtype=np.float64)
            else:
                wanted = f"an array of shape {example.shape} and dtype {example.dtype}"
                if not isinstance(value, np.ndarray) or value.shape != example.shape or value.dtype != example.dtype:
                    raise Misuse(f"{place}: {name} must be {wanted}, got {_kind(value)}")
                yield name, value.copy()


def _kind(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and dtype {value.dtype}"
    return "None (is a return missing?)" if value is None else f"{value!r:.60} ({type(value).__name__})"


def _unchanged(before: Any, after: Any) -> bool:
    if isinstance(before, np.ndarray):
        return isinstance(after, np.ndarray) and before.shape == after.shape and equal(before, after, exact=True)
    return bool(before == after)


def _in_words(given: Arguments) -> str:
    """Returns the arguments as text, without generators and transition tables."""
    lines = []
    for name, value in given.items():
        if name not in ("P", "rng"):
            start = f"{name} = "
            options: dict[str, Any] = {"precision": 6, "threshold": 20, "max_line_width": LINE, "prefix": start}
            lines.append(start + (np.array2string(value, **options) if isinstance(value, np.ndarray) else repr(value)))
    return "\n".join(lines)
