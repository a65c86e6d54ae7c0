"""All experiments of the book, by name and by number."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from qtab._utils.suggestions import did_you_mean
from qtab.book.experiment import Experiment
from qtab.book.figures import (
    chapter_02,
    chapter_03,
    chapter_04,
    chapter_05,
    chapter_06,
    chapter_07,
    chapter_08,
    chapter_09,
    chapter_10,
    chapter_12,
    chapter_13,
)
from qtab.book.result import Result


@dataclass(frozen=True)
class Chapter:
    """A chapter of the book."""

    number: int
    title: str
    experiments: Sequence[Experiment]


CHAPTERS: Sequence[Chapter] = (
    Chapter(2, "Multi-armed bandits", chapter_02.EXPERIMENTS),
    Chapter(3, "Finite Markov decision processes", chapter_03.EXPERIMENTS),
    Chapter(4, "Dynamic programming", chapter_04.EXPERIMENTS),
    Chapter(5, "Monte Carlo methods", chapter_05.EXPERIMENTS),
    Chapter(6, "Temporal-difference learning", chapter_06.EXPERIMENTS),
    Chapter(7, "n-step bootstrapping", chapter_07.EXPERIMENTS),
    Chapter(8, "Planning and learning with tabular methods", chapter_08.EXPERIMENTS),
    Chapter(9, "On-policy prediction with approximation", chapter_09.EXPERIMENTS),
    Chapter(10, "On-policy control with approximation", chapter_10.EXPERIMENTS),
    Chapter(12, "Eligibility traces", chapter_12.EXPERIMENTS),
    Chapter(13, "Policy gradient methods", chapter_13.EXPERIMENTS),
)
"""The chapters that have experiments."""

EXPERIMENTS: Mapping[str, Experiment] = {
    experiment.name: experiment for chapter in CHAPTERS for experiment in chapter.experiments
}
"""The experiments by name, ordered by chapter."""


def find(name: str) -> Experiment:
    """Returns an experiment by its name ("figure-10.4"), or by its number ("10.4") if that is unique.

    Raises:
        TypeError: if the name is not a string.
        ValueError: if no experiment or more than one matches; the message lists the choices.
    """
    if not isinstance(name, str):
        raise TypeError(f"name must be one of {', '.join(EXPERIMENTS)}, got {name!r}")
    wanted = name.strip().lower().replace(" ", "-")
    if wanted in EXPERIMENTS:
        return EXPERIMENTS[wanted]
    matches = [experiment for experiment in EXPERIMENTS.values() if experiment.number == wanted]
    if len(matches) > 1:
        raise ValueError(f"name must be {' or '.join(match.name for match in matches)}, got {name!r}, which is both")
    if not matches:
        suggestion = did_you_mean(wanted, EXPERIMENTS)
        raise ValueError(f"name must be one of {_choices(wanted)}, got {name!r}{suggestion}")
    return matches[0]


def _choices(wanted: str) -> str:
    """Returns the names to choose from: those of the chapter, where the name has its number, or all."""
    number = re.search(r"(?:^|-)(\d+)\b", wanted)
    of_chapter = [chapter for chapter in CHAPTERS if number is not None and chapter.number == int(number[1])]
    if not of_chapter:
        return ", ".join(EXPERIMENTS)
    (chapter,) = of_chapter
    names = ", ".join(experiment.name for experiment in chapter.experiments)
    return f"{names} for chapter {chapter.number}"


def run(
    name: str, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
) -> Result:
    """Runs an experiment of the book.

    Args:
        name: Its name ("figure-10.4"), or its number ("10.4") if that is unique.
        runs: The number of runs of each setting; None means that of the full figure.
        seed: The seed of the first run of each setting; the other runs have the seeds after it.
        threads: The number of threads; None means one per core. It does not change the results.
        progress: Whether to show a progress bar; None shows one on a terminal if it takes longer than a second.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an unknown experiment.
        KeyboardInterrupt: on Ctrl-C.
    """
    return find(name).run(runs, seed, threads=threads, progress=progress)
