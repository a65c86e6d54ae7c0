"""What a function does in a check, event by event: what it changes, draws, chooses and returns."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAX_ENTRIES = 3
"""The maximum number of differing entries of an array that a message lists."""
TOLERANCE = 1e-9
"""The relative difference up to which two numbers differ only by rounding."""


class Misuse(Exception):  # noqa: N818 - a fault of the solution, caught by the grader
    """A solution does what an exercise does not allow. The message addresses the student."""


@dataclass(frozen=True)
class Event:
    """A value to compare."""

    place: str
    """Where it happens: ``"episode 0, step 3"``, or ``"call 2"``."""
    quantity: str
    """The name of the value: ``"q"``, ``"action"``, ``"random numbers"``."""
    value: Any
    """An array, a number, or the state of a random generator."""
    about: object = ""
    """The step or the arguments; ``str`` describes them."""
    episode: int | None = None
    step: int | None = None
    """The episode and its step, counted from 0; -1 is before the first step. None for other functions than learners."""


@dataclass
class Record:
    """The events of one call, and the reason why it was stopped."""

    events: list[Event] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    """What the function did wrong besides its numbers; empty if nothing."""
    was_stopped: bool = False
    """Whether the function did not return in time."""


@dataclass(frozen=True)
class Difference:
    """The first difference between a solution and the reference."""

    place: str
    episode: int | None
    step: int | None
    quantity: str
    yours: Any
    reference: Any
    about: str
    entries: tuple[str, ...]
    """One line for each of the first differing entries."""
    only_rounding: bool
    """Whether everything in the check is equal except for rounding."""
    stopped_early: bool = False
    """Whether everything is equal up to the end of the solution's record, and only the reference's continues."""

    def __str__(self) -> str:
        lines = [f"first difference: {self.place}, {self.quantity} (counted from 0)"]
        return "\n".join([*lines, *(f"  {line}" for line in (*self.about.splitlines(), *self.entries))])


def first_difference(yours: Record, reference: Record, exact: bool = True) -> Difference | None:
    """Returns the first event that differs, or None.

    Args:
        yours: The record of a solution.
        reference: The record of the reference.
        exact: Whether numbers must be equal to the last bit (0.0 equals -0.0), not only up to rounding.
    """
    before: dict[str, Any] = {}
    for mine, other in zip(yours.events, reference.events, strict=False):
        if (mine.place, mine.quantity) != (other.place, other.quantity):
            return _difference(mine, other, (f"the reference is at {other.place}, {other.quantity}",))
        if not equal(mine.value, other.value, exact):
            entries = tuple(_entries(mine.quantity, mine.value, other.value, before.get(mine.quantity)))
            return _difference(mine, other, entries, exact and first_difference(yours, reference, exact=False) is None)
        if mine.episode is not None:
            before[mine.quantity] = other.value
    if len(yours.events) != len(reference.events):
        count = min(len(yours.events), len(reference.events))
        longer = yours if len(yours.events) > count else reference
        ended, continues = "your function", "the reference"
        if longer is yours:
            ended, continues = continues, ended
        event = longer.events[count]
        return _difference(
            event, event, (f"{ended} has ended, {continues} continues",), stopped_early=longer is reference
        )
    return None


def _difference(
    mine: Event, other: Event, entries: tuple[str, ...], only_rounding: bool = False, stopped_early: bool = False
) -> Difference:
    return Difference(
        place=mine.place,
        episode=mine.episode,
        step=mine.step,
        quantity=mine.quantity,
        yours=mine.value,
        reference=other.value,
        about=str(mine.about),
        entries=entries,
        only_rounding=only_rounding,
        stopped_early=stopped_early,
    )


def equal(mine: Any, other: Any, exact: bool) -> bool:
    """Returns whether two values are equal; NaN equals NaN."""
    if not isinstance(other, np.ndarray):
        return bool(mine == other)
    if exact:
        return np.array_equal(mine, other, equal_nan=True)
    return np.allclose(mine, other, rtol=TOLERANCE, atol=TOLERANCE, equal_nan=True)


def _entries(quantity: str, mine: Any, other: Any, before: Any) -> Iterator[str]:
    """Yields a line for each of the first differing entries, with their value ``before``, if that is known."""
    if isinstance(other, dict):
        yield "it drew other random numbers than the reference, or more or fewer"
        return
    if not isinstance(other, np.ndarray):
        yield f"yours {mine}, reference {other}"
        return
    places = np.argwhere(~((mine == other) | (np.isnan(mine) & np.isnan(other)))).tolist()
    for index in places[:MAX_ENTRIES]:
        one, two = shown_apart(mine, other, tuple(index))
        old = f"before {before[tuple(index)]:.6g}, " if isinstance(before, np.ndarray) else ""
        entry = f"{quantity}[{', '.join(map(str, index))}]" if index else quantity
        yield f"{entry}: {old}yours {one}, reference {two}"
    if len(places) > MAX_ENTRIES:
        more = len(places) - MAX_ENTRIES
        yield f"and {more} more {'entry' if more == 1 else 'entries'}"


def shown_apart(mine: NDArray[Any], other: NDArray[Any], index: tuple[int, ...]) -> tuple[str, str]:
    """Returns two numbers as texts: with six digits, or with all of them if six do not show the difference."""
    short = f"{mine[index]:.6g}", f"{other[index]:.6g}"
    return short if short[0] != short[1] else (repr(mine[index].item()), repr(other[index].item()))
