"""All experiments of the book, by name and by number."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType

from qtab._utils.shown import did_you_mean
from qtab.book.experiment import Experiment
from qtab.book.figures import mountain_car, random_walk
from qtab.book.figures.chapter_02 import figure_2_1, figure_2_2, figure_2_3, figure_2_4, figure_2_5, figure_2_6
from qtab.book.figures.chapter_03 import example_3_5, example_3_8
from qtab.book.figures.chapter_04 import figure_4_1, figure_4_2, figure_4_3
from qtab.book.figures.chapter_05 import figure_5_1, figure_5_2, figure_5_3, figure_5_4
from qtab.book.figures.chapter_06 import cliff, example_6_2, example_6_5, figure_6_2, figure_6_5
from qtab.book.figures.chapter_08 import changing_mazes, example_8_4, figure_8_2, figure_8_7, figure_8_8
from qtab.book.figures.chapter_09 import (
    figure_9_1,
    figure_9_2,
    figure_9_5,
    figure_9_8,
    figure_9_10,
    section_9_5_2,
    section_9_8,
)
from qtab.book.figures.chapter_10 import figure_10_1, figure_10_5
from qtab.book.figures.chapter_11 import baird, figure_11_3, split_examples
from qtab.book.figures.chapter_13 import short_corridor
from qtab.book.result import Result


@dataclass(frozen=True)
class Chapter:
    """A chapter of the book."""

    number: int
    title: str
    experiments: Sequence[Experiment]


def _chapter(number: int, title: str, *parts: ModuleType | Experiment) -> Chapter:
    """Returns a chapter from its experiments, and from the modules that have one each."""
    return Chapter(number, title, [part.EXPERIMENT if isinstance(part, ModuleType) else part for part in parts])


CHAPTERS: Sequence[Chapter] = (
    _chapter(2, "Multi-armed bandits", figure_2_1, figure_2_2, figure_2_3, figure_2_4, figure_2_5, figure_2_6),
    _chapter(3, "Finite Markov decision processes", example_3_5, example_3_8),
    _chapter(4, "Dynamic programming", figure_4_1, figure_4_2, figure_4_3),
    _chapter(5, "Monte Carlo methods", figure_5_1, figure_5_2, figure_5_3, figure_5_4),
    _chapter(
        6,
        "Temporal-difference learning",
        *(example_6_2, figure_6_2, example_6_5, cliff.EXAMPLE_6_6, cliff.FIGURE_6_3, figure_6_5),
    ),
    _chapter(7, "n-step bootstrapping", random_walk.FIGURE_7_2),
    _chapter(
        8,
        "Planning and learning with tabular methods",
        *(figure_8_2, changing_mazes.FIGURE_8_4, changing_mazes.FIGURE_8_5, example_8_4, figure_8_7, figure_8_8),
    ),
    _chapter(
        9,
        "On-policy prediction with approximation",
        *(figure_9_1, figure_9_2, figure_9_5, section_9_5_2, figure_9_8, section_9_8, figure_9_10),
    ),
    _chapter(
        10,
        "On-policy control with approximation",
        figure_10_1,
        *(mountain_car.FIGURE_10_2, mountain_car.FIGURE_10_3, mountain_car.FIGURE_10_4),
        figure_10_5,
    ),
    _chapter(
        11,
        "Off-policy methods with approximation",
        *(baird.FIGURE_11_2, figure_11_3, split_examples.EXAMPLE_11_2, split_examples.EXAMPLE_11_3),
        *(baird.FIGURE_11_5, baird.FIGURE_11_6),
    ),
    _chapter(
        12,
        "Eligibility traces",
        *(random_walk.FIGURE_12_3, random_walk.FIGURE_12_6, random_walk.FIGURE_12_8),
        *(mountain_car.FIGURE_12_10, mountain_car.FIGURE_12_11),
    ),
    _chapter(
        13,
        "Policy gradient methods",
        *(short_corridor.EXAMPLE_13_1, short_corridor.FIGURE_13_1, short_corridor.FIGURE_13_2),
    ),
)
"""The chapters that have experiments."""

EXPERIMENTS: Mapping[str, Experiment] = {
    experiment.name: experiment for chapter in CHAPTERS for experiment in chapter.experiments
}
"""The experiments by name, ordered by chapter."""


def find(name: str) -> Experiment:
    """Returns an experiment by its name ("figure-10.4") or by its number ("10.4").

    A number that a figure and an example share is that of the figure.

    Raises:
        TypeError: if the name is not a string.
        ValueError: if no experiment matches; the message lists the choices.
    """
    if not isinstance(name, str):
        raise TypeError(f"name must be one of {', '.join(EXPERIMENTS)}, got {name!r}")
    wanted = name.strip().lower().replace(" ", "-").replace("_", "-")
    if wanted in EXPERIMENTS:
        return EXPERIMENTS[wanted]
    matches = [experiment for experiment in EXPERIMENTS.values() if experiment.number == wanted]
    if not matches:
        suggestion = did_you_mean(wanted, EXPERIMENTS)
        raise ValueError(f"name must be {_choices(wanted)}, got {name!r}{suggestion}")
    return max(matches, key=_is_figure)


def same_number(experiment: Experiment) -> Sequence[Experiment]:
    """Returns the other experiments with the number of an experiment: an example with that of a figure."""
    return [one for one in EXPERIMENTS.values() if one.number == experiment.number and one is not experiment]


def _is_figure(experiment: Experiment) -> bool:
    return experiment.name.startswith("figure-")


def _choices(wanted: str) -> str:
    """Returns the names to choose from: those of a chapter if ``wanted`` has its number, else all."""
    number = re.search(r"(?:^|-)(\d+)\b", wanted)
    of_chapter = [chapter for chapter in CHAPTERS if number is not None and chapter.number == int(number[1])]
    if not of_chapter:
        return f"one of {', '.join(EXPERIMENTS)}"
    (chapter,) = of_chapter
    names = ", ".join(experiment.name for experiment in chapter.experiments)
    return f"{'one of ' if len(chapter.experiments) > 1 else ''}{names} for chapter {chapter.number}"


def run(
    name: str, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
) -> Result:
    """Runs an experiment of the book.

    Args:
        name: Its name ("figure-10.4") or its number ("10.4"), which is that of the figure if an example shares it.
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
