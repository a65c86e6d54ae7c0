"""Chapter 9: on-policy prediction with approximation."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_09 import figure_9_1, figure_9_2, figure_9_10

EXPERIMENTS: Sequence[Experiment] = (figure_9_1.EXPERIMENT, figure_9_2.EXPERIMENT, figure_9_10.EXPERIMENT)
