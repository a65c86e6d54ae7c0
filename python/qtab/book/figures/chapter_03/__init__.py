"""Chapter 3: finite Markov decision processes."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment
from qtab.book.figures.chapter_03 import example_3_5, example_3_8

EXPERIMENTS: Sequence[Experiment] = (
    example_3_5.EXPERIMENT,
    example_3_8.EXPERIMENT,
)
