"""Experiments of Sutton & Barto, *Reinforcement Learning*, 2nd edition (2018), one command each.

    import qtab

    result = qtab.book.run("10.4")
    print(result)
    result.plot()
    qtab.book.run_all("figures")

The experiments are in :mod:`qtab.book.figures`, by chapter, with their settings, including those that the book leaves
open.
"""

from qtab.book.collection import run_all
from qtab.book.experiment import Experiment
from qtab.book.line import Line
from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.registry import CHAPTERS, EXPERIMENTS, Chapter, find, run
from qtab.book.result import Result
from qtab.book.setting import Setting
from qtab.envs.grid_worlds import dyna_maze, grid_world, windy_grid_world

__all__ = [
    "CHAPTERS",
    "EXPERIMENTS",
    "Chapter",
    "Experiment",
    "Line",
    "Result",
    "Setting",
    "TrainingExperiment",
    "dyna_maze",
    "find",
    "grid_world",
    "run",
    "run_all",
    "windy_grid_world",
]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]
