"""Plots of many runs. Every function draws on the axes it is given, or on a new figure, and returns the axes.

They need the extra ``plot``; those with confidence intervals also need ``stats``.
"""

from qtab.plots.distribution import distribution
from qtab.plots.learning_curves import learning_curves
from qtab.plots.profile import profile
from qtab.plots.sensitivity import sensitivity

__all__ = ["distribution", "learning_curves", "profile", "sensitivity"]
