"""Chapter 2: multi-armed bandits."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_02 import figure_2_1, figure_2_2, figure_2_3, figure_2_4, figure_2_5, figure_2_6

EXPERIMENTS: Sequence[Experiment] = (
    figure_2_1.EXPERIMENT,
    figure_2_2.EXPERIMENT,
    figure_2_3.EXPERIMENT,
    figure_2_4.EXPERIMENT,
    figure_2_5.EXPERIMENT,
    figure_2_6.EXPERIMENT,
)
