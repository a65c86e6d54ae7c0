"""An exercise: the function to write, its checks, and the mistakes to recognise."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from qtab._utils.fields import with_fields
from qtab.exercises.record import Record

Solution = Callable[..., Any]


class Check(Protocol):
    """A call of the function with certain settings, or several calls."""

    @property
    def title(self) -> str:
        """The settings, in a few words."""

    @property
    def changes(self) -> Sequence[str]:
        """The names of the arrays that the function changes in place."""

    def run(self, function: Solution, record: Record, seconds: float) -> None:
        """Calls a function, and fills its record.

        Raises:
            Misuse: if the function does what the exercise does not allow.
        """


@with_fields
@dataclass(frozen=True, repr=False)
class Exercise:
    """A function to write. Pass an exercise of your own to :func:`qtab.exercises.check` in place of a name."""

    number: int
    """Its number, from 1 to 12; any other number in an exercise of your own."""
    name: str
    """Its name, which is that of the function: ``"sarsa"``."""
    title: str
    """Its title: ``"Sarsa"``."""
    section: str
    """The section of Sutton & Barto, 2nd edition: ``"6.4"``."""
    starter: str
    """The code to start from: the function without its body. Its docstring is the task."""
    model: Solution
    """The function of the reference. Its parameter ``wrong`` has the keys of mistakes to build in, a frozenset of str;
    without mistakes, it needs no such parameter."""
    mistakes: Sequence[str] | Mapping[str, str]
    """The keys of the mistakes that a check may recognise: those that qtab explains, or explanations of your own by
    their keys; empty for none."""
    checks: Sequence[Check]
    """The checks, from simple to hard: each a :class:`~qtab.exercises.FunctionCheck` or a
    :class:`~qtab.exercises.LearnerCheck`."""

    def __repr__(self) -> str:
        """Returns one line; ``print(exercise.starter)`` shows the task."""
        return f"<Exercise {self.number}, {self.name}: {self.title}, section {self.section}>"


def parameters(model: Solution) -> list[str]:
    """Returns the names of the arguments that a solution takes, in order."""
    return [name for name in inspect.signature(model).parameters if name != "wrong"]
