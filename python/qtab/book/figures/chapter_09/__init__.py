"""Chapter 9: on-policy prediction with approximation."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment

EXPERIMENTS: Sequence[Experiment] = ()
