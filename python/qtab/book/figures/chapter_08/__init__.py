"""Chapter 8: planning and learning with tabular methods."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_08 import figure_8_2

EXPERIMENTS: Sequence[Experiment] = (figure_8_2.EXPERIMENT,)
