"""Chapter 5: Monte Carlo methods."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment

EXPERIMENTS: Sequence[Experiment] = ()
