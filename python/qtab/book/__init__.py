"""Experiments of Sutton & Barto, *Reinforcement Learning*, 2nd edition (2018), with the book's numbers of runs.

    import qtab

    result = qtab.book.run("10.4")
    print(result)
    result.plot()

Each experiment is a module of :mod:`qtab.book.figures`, which states its settings and what the book leaves open.
"""

from qtab.book.experiment import Experiment
from qtab.book.registry import EXPERIMENTS, find, run
from qtab.book.result import Line, Result
from qtab.book.setting import Setting
from qtab.envs.grid_worlds import dyna_maze, grid_world, windy_grid_world

__all__ = [
    "EXPERIMENTS",
    "Experiment",
    "Line",
    "Result",
    "Setting",
    "dyna_maze",
    "find",
    "grid_world",
    "run",
    "windy_grid_world",
]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]
