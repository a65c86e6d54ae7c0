"""Chapter 12: eligibility traces."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_12 import figure_12_10, figure_12_11, random_walk

EXPERIMENTS: Sequence[Experiment] = (
    random_walk.FIGURE_12_3,
    random_walk.FIGURE_12_6,
    random_walk.FIGURE_12_8,
    figure_12_10.EXPERIMENT,
    figure_12_11.EXPERIMENT,
)
