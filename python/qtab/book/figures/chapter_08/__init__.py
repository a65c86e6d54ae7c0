"""Chapter 8: planning and learning with tabular methods."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_08 import example_8_4, figure_8_2, figure_8_4, figure_8_5, figure_8_7, figure_8_8

EXPERIMENTS: Sequence[Experiment] = (
    figure_8_2.EXPERIMENT,
    figure_8_4.EXPERIMENT,
    figure_8_5.EXPERIMENT,
    example_8_4.EXPERIMENT,
    figure_8_7.EXPERIMENT,
    figure_8_8.EXPERIMENT,
)
