"""List the exercises, show a task, hand out tasks to a class, or grade a folder of submissions."""

import tempfile
from argparse import Namespace
from pathlib import Path

from qtab import exercises
from qtab._utils.files import check_writable
from qtab._utils.progress import print_above
from qtab.cli.errors import UsageError, usage_errors
from qtab.cli.parser import Parser
from qtab.cli.values import number, true_or_false


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    names = "Names or numbers, separated by commas, such as 1,sarsa; without them, the exercises are listed."
    parser.positional("exercises", names, _names, default=None, metavar="NAMES")
    parser.option("out", Path, "Write the tasks to this file, which ends in .ipynb or .py, to hand it out.")
    grade = "Grade the submissions in this folder: a folder, a .py file or a notebook for each student."
    parser.option("grade", Path, grade, metavar="FOLDER")
    parser.option("save", Path, "With --grade: write the marks to this CSV file.")
    parser.option("reports", Path, "With --grade: write each student's reports to a text file in it.", metavar="FOLDER")
    exact = "With --grade: whether numbers must be equal to the last bit, or may differ by rounding."
    parser.option("exact", true_or_false, exact, True, metavar="BOOL")
    parser.option("seconds", number, "With --grade: the time limit of each call.", 10.0)


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    if options.exercises is None:
        if options.out is not None or options.grade is not None:
            raise UsageError("NAMES must be given with --out or --grade; qtab exercises lists the names")
        _list()
        return 0
    if options.grade is None and (options.save is not None or options.reports is not None):
        raise UsageError("--grade must be given with --save or --reports")
    if options.grade is not None and options.out is not None:
        raise UsageError("--out must be left out with --grade")
    with usage_errors(options):
        found = [_find(name) for name in options.exercises]
    if options.grade is not None:
        return _grade(options)
    if options.out is not None:
        if options.out.suffix not in (".ipynb", ".py"):
            raise UsageError(f"--out must end in .ipynb or .py, got {str(options.out)!r}")
        with usage_errors(options):
            check_writable("out", options.out)
            exercises.hand_out(options.exercises, options.out)
        print_above(f"Saved the tasks to {options.out}")
    else:
        print_above("\n\n".join(exercise.starter for exercise in found).rstrip("\n"))
    return 0


def _find(name: str) -> exercises.Exercise:
    """Returns an exercise.

    Raises:
        UsageError: if there is no such exercise.
    """
    try:
        return exercises.find(name)
    except (ValueError, ImportError) as error:
        raise UsageError(
            f"NAMES: {error}".replace("qtab.exercises.EXERCISES lists them", "`qtab exercises` lists them")
        ) from None


def _names(word: str) -> list[str]:
    return word.split(",")


def _list() -> None:
    for exercise in exercises.EXERCISES.values():
        print_above(f"{exercise.number:>2}  {exercise.name:19}{exercise.title}, section {exercise.section}")


def _grade(options: Namespace) -> int:
    if not options.grade.is_dir():
        raise UsageError(f"--grade must be a folder of submissions, got {str(options.grade)!r}")
    with usage_errors(options):  # the files are checked first, since grading may take minutes
        if options.save is not None:
            check_writable("save", options.save)
        if options.reports is not None:
            _check_folder(options.reports)
        marks = exercises.grade(options.grade, options.exercises, exact=options.exact, seconds=options.seconds)
    print_above(str(marks))
    if options.save is not None:
        marks.save(options.save)
        print_above(f"Saved the marks to {options.save}")
    if options.reports is not None:
        marks.save_reports(options.reports)
        print_above(f"Saved the reports to {options.reports}")
    return 0


def _check_folder(folder: Path) -> None:
    """Makes the folder of the reports, and checks that files can be written to it.

    Raises:
        UsageError: if not.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise UsageError(
            f"--reports must be a folder that can be written, got {str(folder)!r}: {error.strerror}"
        ) from None
