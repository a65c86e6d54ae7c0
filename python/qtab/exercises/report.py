"""The result of checking a solution."""

import textwrap
from dataclasses import dataclass, field
from typing import Any

from qtab._utils import html
from qtab._utils.fields import with_fields
from qtab.exercises.exercise import Exercise
from qtab.exercises.recognition import Recognition
from qtab.exercises.record import Difference

WIDTH = 86
"""The maximum number of characters in a line of a report as text."""

AS_BEFORE = "the same as in the check above"
"""Stands for a fault that the check before has as well."""
ALLOWED = "Nothing differs by more than rounding: exact=False accepts this"


@with_fields
@dataclass(frozen=True)
class CheckResult:
    """The result of one check."""

    title: str
    """The settings of the check."""
    faults: tuple[str, ...]
    """What the function did wrong besides its numbers, such as an exception that it raised."""
    difference: Difference | None
    """The first difference from the reference; None if there is none, or if the function was stopped before one."""
    exact: bool
    """Whether a difference by rounding counts."""

    @property
    def passed(self) -> bool:
        """Whether the function was not at fault, and its numbers are those of the reference."""
        return not self.faults and (self.difference is None or (not self.exact and self.difference.only_rounding))

    @property
    def lines(self) -> list[str]:
        """What is wrong, line by line; empty if the check passed."""
        if self.passed:
            return []
        lines = list(self.faults)
        if self.difference is not None:
            lines += str(self.difference).splitlines()
            if self.difference.only_rounding:
                lines.append("  everything is equal except for rounding: the operations are in another order")
        return lines


@with_fields
@dataclass(frozen=True, repr=False)
class Report:
    """The result of :func:`qtab.exercises.check`: what passed, the first differences, recognised mistakes."""

    exercise: Exercise
    results: tuple[CheckResult, ...]
    """The result of each check, in order."""
    recognition: Recognition = field(default_factory=Recognition)
    """The recognised mistakes."""
    advice: tuple[str, ...] = ()
    """Other remarks, such as on an array that never changes."""

    @property
    def mistakes(self) -> tuple[str, ...]:
        """An explanation of each recognised mistake: with them, the reference gives the numbers of the solution."""
        return self.recognition.mistakes

    @property
    def passed(self) -> bool:
        """Whether all checks passed."""
        return all(result.passed for result in self.results)

    def assert_passed(self) -> None:
        """Does nothing if all checks passed.

        Raises:
            AssertionError: if one did not. Its message is the report.
        """
        if not self.passed:
            raise AssertionError(f"\n{self}")

    def __repr__(self) -> str:
        """Returns one line; ``print`` shows the whole report."""
        return f"<Report on {self._heading}>"

    def __str__(self) -> str:
        """Returns the report as text."""
        lines = [self._heading]
        for result, shown in zip(self.results, self._lines(), strict=True):
            lines.append(f"  {_word(result)}  {result.title}")
            lines += [wrapped for line in shown for wrapped in _wrapped(line, " " * 10)]
        return "\n".join([*lines, *(wrapped for note in self._notes() for wrapped in _wrapped(note))])

    def _repr_html_(self) -> str:
        """Returns the report as a table, for notebooks."""
        shown = zip(self.results, self._lines(), strict=True)
        rows = [(_word(result), "\n".join([result.title, *lines])) for result, lines in shown]
        return html.sentences(self._heading, (), rows, self._notes())

    @property
    def _heading(self) -> str:
        count = sum(result.passed for result in self.results)
        found = f"all {count} checks passed" if self.passed else f"{count} of {len(self.results)} checks passed"
        if len(self.results) == 1:
            found = f"its check {'passed' if self.passed else 'failed'}"
        return f"exercise {self.exercise.number}, {self.exercise.name}: {found}"

    def _lines(self) -> list[list[str]]:
        """The lines of each result. A fault that the result before it has as well is not repeated."""
        shown: list[list[str]] = []
        before: tuple[str, ...] = ()
        for result in self.results:
            count = len(result.faults)
            faults = [AS_BEFORE if fault in before else fault for fault in result.faults]
            shown.append(list(dict.fromkeys(faults)) + result.lines[count:])
            before = result.faults
        return shown

    def _notes(self) -> list[str]:
        failed = [result for result in self.results if not result.passed]
        only_rounding = all(
            not result.faults and result.difference is not None and result.difference.only_rounding for result in failed
        )
        allowed = [ALLOWED] if failed and only_rounding else []
        return [*self.recognition.lines, *self.advice, *allowed]


def _wrapped(line: str, indent: str = "") -> list[str]:
    """Returns a line of text as several ones that are not too long; all but the first are indented."""
    spaces = indent + " " * (len(line) - len(line.lstrip()))
    options: Any = {"break_long_words": False, "break_on_hyphens": False}
    return textwrap.wrap(line.strip(), WIDTH, initial_indent=spaces, subsequent_indent=f"{spaces}  ", **options)


def _word(result: CheckResult) -> str:
    return "passed" if result.passed else "FAILED"
