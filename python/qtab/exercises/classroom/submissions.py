"""The files that students handed in, in a folder."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

SUFFIXES = (".py", ".ipynb")


@dataclass(frozen=True)
class Submission:
    """The files of a student."""

    student: str
    """The name of the student's folder, or that of a single file without its suffix."""
    files: tuple[Path, ...]
    """Python files and notebooks, by name; empty if a folder has none."""


def submissions(folder: Path) -> list[Submission]:
    """Returns the submissions in a folder, by student.

    Args:
        folder: It has a folder for each student, or a file, ``.py`` or ``.ipynb``, or both. Names that begin with
            a dot or two underscores, such as ``.ipynb_checkpoints`` and ``__pycache__``, are left out.

    Raises:
        ValueError: if it is not a folder, or has no submission.
        OSError: if it cannot be read.
    """
    if not folder.is_dir():
        raise ValueError(f"folder must be a folder of submissions, got {str(folder)!r}")
    files: dict[str, list[Path]] = {}
    for entry in sorted(folder.iterdir()):
        if _is_hidden(entry.name):
            continue
        if entry.is_dir():
            files.setdefault(entry.name, []).extend(_files_below(entry))
        elif entry.suffix in SUFFIXES:
            files.setdefault(entry.stem, []).append(entry)
    if not files:
        raise ValueError(f"folder must hold a .py file, a notebook or a folder of each student, got {str(folder)!r}")
    return [Submission(student, tuple(found)) for student, found in sorted(files.items())]


def _files_below(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.rglob("*")):
        parts = path.relative_to(folder).parts
        if path.suffix in SUFFIXES and path.is_file() and not any(map(_is_hidden, parts)):
            yield path


def _is_hidden(name: str) -> bool:
    return name.startswith((".", "__"))
