"""Recognises mistakes: builds each of them into the reference, and looks for the one that gives the same numbers."""

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations

import numpy as np

from qtab.exercises.exercise import Check, Exercise
from qtab.exercises.mistakes import MISTAKES
from qtab.exercises.record import Event, Misuse, Record, equal

MODEL_SECONDS = 60.0
"""The time limit of the reference, which never needs it."""
ROUNDING = "rounding"
"""The mistake that changes nothing but the rounding."""


@dataclass(frozen=True)
class Recognition:
    """The mistakes with which the reference gives the numbers of a solution."""

    mistakes: tuple[str, ...] = ()
    """An explanation of each; empty if none was recognised."""
    alternatives: bool = False
    """Whether each of them alone gives these numbers, because the checks cannot distinguish them."""
    exact: bool = True
    """Whether the numbers are the same to the last bit, and not only up to rounding."""
    in_all_checks: bool = True
    """Whether all checks were compared, and not only those that the solution finished."""

    @property
    def lines(self) -> list[str]:
        """The explanations after a sentence on what they are."""
        if not self.mistakes:
            return []
        if len(self.mistakes) == 1:
            built_in = "this mistake"
        else:
            built_in = "any one of these mistakes" if self.alternatives else f"these {len(self.mistakes)} mistakes"
        where = "in all checks" if self.in_all_checks else "in the checks that it finished"
        rounding = "" if self.exact else ", except for rounding"
        return [
            f"The reference with {built_in} built in gives the same numbers as your function {where}{rounding}:",
            *(f"- {mistake}" for mistake in self.mistakes),
        ]


def recognised(exercise: Exercise, records: Sequence[Record]) -> Recognition:
    """Returns the mistakes with which the reference gives the same records: one, or two made together.

    Args:
        exercise: The exercise.
        records: The records of a solution in all of its checks. Those of calls with a fault are left out.

    Returns:
        The mistakes; none if the remaining records are those of the reference, since a mistake that has no effect in
        these checks would explain them, too.
    """
    pairs = zip(exercise.checks, records, strict=True)
    finished = [(one, record) for one, record in pairs if record.events and not record.faults]
    if not finished:
        return Recognition()
    in_all = len(finished) == len(records)
    if _explains(exercise, set(), finished, exact=False):  # nothing but rounding is wrong in these checks
        same = _explains(exercise, set(), finished, exact=True)
        if not same and ROUNDING in exercise.mistakes and _explains(exercise, {ROUNDING}, finished, exact=True):
            return Recognition((MISTAKES[ROUNDING],), in_all_checks=in_all)
        return Recognition()
    texts = exercise.mistakes if isinstance(exercise.mistakes, Mapping) else MISTAKES
    for exact in (True, False):
        keys = [key for key in exercise.mistakes if exact or key != ROUNDING]
        single = [key for key in keys if _explains(exercise, {key}, finished, exact)]
        if single:
            return Recognition(tuple(texts[key] for key in single), len(single) > 1, exact, in_all)
        for pair in combinations(keys, 2):
            if _explains(exercise, set(pair), finished, exact):
                return Recognition(tuple(texts[key] for key in pair), False, exact, in_all)
    return Recognition()


def _explains(exercise: Exercise, keys: set[str], finished: Sequence[tuple[Check, Record]], exact: bool) -> bool:
    """Returns whether the reference with these mistakes built in gives the same records."""
    model = exercise.model
    if "wrong" in inspect.signature(model).parameters:
        model = partial(model, wrong=frozenset(keys))
    for one, record in finished:
        theirs = Record(_Same(record.events, exact))
        try:
            with np.errstate(all="ignore"):  # values may diverge
                one.run(model, theirs, MODEL_SECONDS)
        except Misuse:
            return False
        if len(theirs.events) != len(record.events):
            return False
    return True


class _Same(list[Event]):
    """Events that must be the same as others: the first one that differs ends the call, which saves time."""

    def __init__(self, others: Sequence[Event], exact: bool) -> None:
        super().__init__()
        self._others, self._exact = others, exact

    def append(self, event: Event) -> None:
        other = self._others[len(self)] if len(self) < len(self._others) else None
        if other is None or (event.place, event.quantity) != (other.place, other.quantity):
            raise Misuse("another order of events")
        if not equal(other.value, event.value, self._exact):
            raise Misuse("another value")
        super().append(event)
