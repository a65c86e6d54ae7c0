"""Chapter 5: Monte Carlo methods."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_05 import figure_5_1, figure_5_2, figure_5_3, figure_5_4

EXPERIMENTS: Sequence[Experiment] = (
    figure_5_1.EXPERIMENT,
    figure_5_2.EXPERIMENT,
    figure_5_3.EXPERIMENT,
    figure_5_4.EXPERIMENT,
)
