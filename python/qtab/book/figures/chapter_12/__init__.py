"""Chapter 12: eligibility traces."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_12 import figure_12_3, figure_12_6, figure_12_8, figure_12_10, figure_12_11

EXPERIMENTS: Sequence[Experiment] = (
    figure_12_3.EXPERIMENT,
    figure_12_6.EXPERIMENT,
    figure_12_8.EXPERIMENT,
    figure_12_10.EXPERIMENT,
    figure_12_11.EXPERIMENT,
)
