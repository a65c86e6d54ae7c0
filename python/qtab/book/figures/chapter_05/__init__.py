"""Chapter 5: Monte Carlo methods."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_05 import figure_5_2

EXPERIMENTS: Sequence[Experiment] = (figure_5_2.EXPERIMENT,)
