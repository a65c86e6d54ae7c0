"""Chapter 10: on-policy control with approximation."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_10 import figure_10_1, figure_10_2, figure_10_3, figure_10_4, figure_10_5

EXPERIMENTS: Sequence[Experiment] = (
    figure_10_1.EXPERIMENT,
    figure_10_2.EXPERIMENT,
    figure_10_3.EXPERIMENT,
    figure_10_4.EXPERIMENT,
    figure_10_5.EXPERIMENT,
)
