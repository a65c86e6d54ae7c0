"""The result of ``qtab.exercises.grade``."""

import csv
from dataclasses import dataclass
from os import PathLike

from qtab._utils import checks, html
from qtab._utils.fields import with_fields
from qtab._utils.files import replacing
from qtab._utils.shown import counted, did_you_mean
from qtab.exercises.exercise import Exercise


def without_checks(exercise: Exercise, reason: str) -> str:
    """Returns the report on a function that could not be checked."""
    return f"exercise {exercise.number}, {exercise.name}: {reason}"


@with_fields
@dataclass(frozen=True)
class Mark:
    """The mark of one student in one exercise."""

    student: str
    """The name of the student's folder or file."""
    exercise: str
    """The name of the exercise."""
    passed: int
    """The number of checks that the function passed."""
    checks: int
    """The number of checks."""
    report: str
    """The report, as text."""


@with_fields
@dataclass(frozen=True, repr=False)
class Marks:
    """The marks of a class: ``print`` shows them as a table, and a notebook, too."""

    exercises: tuple[str, ...]
    """The names of the exercises."""
    marks: tuple[Mark, ...]
    """The mark of every student in every exercise, by student."""

    @property
    def students(self) -> tuple[str, ...]:
        """The names of the students."""
        return tuple(dict.fromkeys(mark.student for mark in self.marks))

    def of(self, student: str) -> tuple[Mark, ...]:
        """Returns the marks of a student, in the order of the exercises.

        Raises:
            ValueError: if there is no such student.
        """
        if student not in self.students:
            raise ValueError(f"there is no submission of {student!r}{did_you_mean(student, self.students)}")
        return tuple(mark for mark in self.marks if mark.student == student)

    def save(self, path: str | PathLike[str]) -> None:
        """Writes a CSV file: a row for each student, with the number of checks passed in each exercise, and their sum.

        Raises:
            OSError: if the file cannot be written.
        """
        with (
            replacing(checks.file_path("path", path)) as temporary,
            temporary.open("w", newline="", encoding="utf-8") as file,
        ):
            rows = csv.writer(file)
            rows.writerow(["student", *(f"{name} (of {most})" for name, most in self._columns)])
            rows.writerows([student, *self._points(student)] for student in self.students)

    def save_reports(self, folder: str | PathLike[str]) -> None:
        """Writes the reports of each student to a text file in a folder, to hand back.

        Raises:
            OSError: if a file cannot be written.
        """
        where = checks.file_path("folder", folder)
        where.mkdir(parents=True, exist_ok=True)
        for student in self.students:
            text = "\n\n".join(mark.report for mark in self.of(student))
            (where / f"{student}.txt").write_text(f"{text}\n", encoding="utf-8")

    def __repr__(self) -> str:
        """Returns one line."""
        return f"<Marks of {counted(len(self.students), 'student')} in {', '.join(self.exercises)}>"

    def __str__(self) -> str:
        """Returns the marks as a table."""
        rows = [["student", *(name for name, _ in self._columns)], *self._rows()]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ["  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)) for row in rows]
        return "\n".join(line.rstrip() for line in lines)

    def _repr_html_(self) -> str:
        """Returns the marks as a table, for notebooks."""
        columns = ["student", *(name for name, _ in self._columns)]
        return html.listing("checks passed", columns, self._rows())

    def _rows(self) -> list[list[str]]:
        most = [count for _, count in self._columns]
        return [
            [student, *(f"{passed} of {count}" for passed, count in zip(self._points(student), most, strict=True))]
            for student in self.students
        ]

    @property
    def _columns(self) -> list[tuple[str, int]]:
        """The heading of each column, and the number of checks of it."""
        first = self.of(self.students[0]) if self.marks else ()
        return [*((mark.exercise, mark.checks) for mark in first), ("sum", sum(mark.checks for mark in first))]

    def _points(self, student: str) -> list[int]:
        passed = [mark.passed for mark in self.of(student)]
        return [*passed, sum(passed)]
