"""Chapter 7: n-step bootstrapping."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_07 import figure_7_2

EXPERIMENTS: Sequence[Experiment] = (figure_7_2.EXPERIMENT,)
