"""The truth: the best that can be returned, or the best that is known, and how far a run is from it."""

from qtab.planning.gap import Gap
from qtab.planning.optimum import Optimum
from qtab.planning.solve import optimum

__all__ = ["Gap", "Optimum", "optimum"]
