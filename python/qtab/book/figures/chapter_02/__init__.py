"""Chapter 2: multi-armed bandits."""

from collections.abc import Sequence

from qtab.book.experiment import Experiment

EXPERIMENTS: Sequence[Experiment] = ()
