"""Chapter 6: temporal-difference learning."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_06 import (
    example_6_2,
    example_6_5,
    example_6_6,
    figure_6_2,
    figure_6_3,
    figure_6_5,
)

EXPERIMENTS: Sequence[Experiment] = (
    example_6_2.EXPERIMENT,
    figure_6_2.EXPERIMENT,
    example_6_5.EXPERIMENT,
    example_6_6.EXPERIMENT,
    figure_6_3.EXPERIMENT,
    figure_6_5.EXPERIMENT,
)
