"""The book's experiments at the book's run counts (Sutton & Barto, *Reinforcement Learning*, 2nd edition, 2018).

    import qtab

    result = qtab.book.run("10.4")
    print(result)
    result.plot()

Each experiment is a module of this package that says its settings, and what the book leaves open.
"""

from qtab.book.experiment import Experiment, Line, Result, Setting
from qtab.book.registry import EXPERIMENTS, find, run
from qtab.envs.grid_worlds import dyna_maze, windy_grid_world

__all__ = [
    "EXPERIMENTS",
    "Experiment",
    "Line",
    "Result",
    "Setting",
    "dyna_maze",
    "find",
    "run",
    "windy_grid_world",
]
