"""Chapter 13: policy gradient methods."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_13 import example_13_1, figure_13_1, figure_13_2

EXPERIMENTS: Sequence[Experiment] = (example_13_1.EXPERIMENT, figure_13_1.EXPERIMENT, figure_13_2.EXPERIMENT)
