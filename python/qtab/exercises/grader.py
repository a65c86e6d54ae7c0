"""``qtab.exercises.check``: a student's function against the reference, to the last bit."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.exercises.collection import find
from qtab.exercises.exercise import Check, Exercise
from qtab.exercises.guard import GLOBAL_NUMPY, GLOBAL_PYTHON
from qtab.exercises.learner_check import SAMPLES
from qtab.exercises.recognition import MODEL_SECONDS, recognised
from qtab.exercises.record import Misuse, Record, equal, first_difference
from qtab.exercises.recording_env import RANDOM_NUMBERS
from qtab.exercises.report import CheckResult, Report

NEVER_CHANGED = (
    "{table} never changes: change the array that you are given, as in {table}[...] += ..., and not a copy of it. "
    "Nothing needs to be returned"
)

AFTER_A_STOP = 2.0
"""The most seconds of a call after one that was stopped, so that a report on an endless loop does not take long."""


def check(
    exercise: str | int | Exercise, solution: Callable[..., Any], *, exact: bool = True, seconds: float = 10.0
) -> Report:
    """Checks a function that you wrote against the reference, to the last bit.

    The function is called with the arguments that its exercise lists, in their order, in a few small checks. A
    learner's tables, random numbers and actions are compared after every step, so that the report names the first
    episode, step and number that differ. If they do, the checks are repeated with known mistakes built into the
    reference, one or two at a time: a mistake that gives exactly the same numbers is explained.

    A function that raises an exception, does not return in time, returns a value of the wrong shape or type, changes
    arguments that it should not change, or uses a global random generator fails this check, and the next one follows.
    See :mod:`qtab.exercises.time_limit` for what the time limit cannot end.

    Args:
        exercise: The name of the exercise, such as ``"sarsa"``, or its number, from 1 to 12; or an
            :class:`~qtab.exercises.Exercise` of your own.
        solution: The function.
        exact: Whether the numbers must be equal to the last bit. With False a check passes if all numbers of it are
            equal except for rounding (a relative difference of 1e-9).
        seconds: The time limit of each call. After a call that was stopped it is at most 2 seconds.

    Returns:
        The report. In a notebook it shows itself; ``report.passed`` is True if all checks passed, and
        ``report.assert_passed()`` raises an AssertionError otherwise, for pytest.

    Raises:
        TypeError: for an argument of the wrong type, such as a solution that cannot be called.
        ValueError: if there is no such exercise, or for a time limit that is not positive.
    """
    found = find(exercise)
    if not callable(solution):
        raise TypeError(f"solution must be a function, such as {found.name}, got {shown(solution)}")
    checks.boolean("exact", exact)
    if checks.finite("seconds", seconds) <= 0.0:
        raise ValueError(f"seconds must be positive, got {seconds!r}")
    records: list[Record] = []
    for one in found.checks:
        was_stopped = any(record.was_stopped for record in records)
        records.append(_record(one, solution, min(seconds, AFTER_A_STOP) if was_stopped else seconds))
    references = [_record(one, found.model, MODEL_SECONDS) for one in found.checks]
    results = []
    for one, mine, reference in zip(found.checks, records, references, strict=True):
        difference = first_difference(mine, reference)
        if mine.faults and difference is not None and difference.stopped_early:
            difference = None  # everything is equal until the function was stopped
        results.append(CheckResult(one.title, tuple(mine.faults), difference, exact))
    report = Report(found, tuple(results))
    if report.passed:
        return report
    return replace(report, recognition=recognised(found, records), advice=tuple(_advice(found, records, references)))


def _record(one: Check, function: Callable[..., Any], seconds: float) -> Record:
    """Returns the record of a check, with the reason if the function was stopped."""
    record = Record()
    try:
        one.run(function, record, seconds)
    except Misuse as misuse:
        record.faults.insert(0, str(misuse))
    return record


def _advice(exercise: Exercise, records: Sequence[Record], references: Sequence[Record]) -> Iterator[str]:
    """Yields remarks on arrays that never change and generators that are never used, if all calls returned."""
    tables = {name for one in exercise.checks for name in one.changes}
    if any(fault not in (GLOBAL_NUMPY, GLOBAL_PYTHON, SAMPLES) for record in records for fault in record.faults):
        return
    for quantity in {event.quantity: None for reference in references for event in reference.events}:
        if not (_constant(records, quantity) and not _constant(references, quantity)):
            continue
        if quantity == RANDOM_NUMBERS:
            yield "rng is never used: draw all random numbers from it"
        elif quantity in tables:
            yield NEVER_CHANGED.format(table=quantity)


def _constant(records: Sequence[Record], quantity: str) -> bool:
    """Returns whether a quantity is recorded, and keeps its first value in every record."""
    compared = 0
    for record in records:
        values = [event.value for event in record.events if event.quantity == quantity]
        compared += len(values)
        if not all(equal(value, values[0], exact=True) for value in values):
            return False
    return compared > len(records)
