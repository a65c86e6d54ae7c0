"""Chapter 4: dynamic programming."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_04 import figure_4_1, figure_4_2, figure_4_3

EXPERIMENTS: Sequence[Experiment] = (
    figure_4_1.EXPERIMENT,
    figure_4_2.EXPERIMENT,
    figure_4_3.EXPERIMENT,
)
