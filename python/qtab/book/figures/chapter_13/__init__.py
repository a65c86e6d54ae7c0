"""Chapter 13: policy gradient methods."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment

EXPERIMENTS: Sequence[Experiment] = ()
