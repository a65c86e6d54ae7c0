"""Chapter 7: n-step bootstrapping."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment

EXPERIMENTS: Sequence[Experiment] = ()
