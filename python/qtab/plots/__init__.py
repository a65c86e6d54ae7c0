"""Pictures of many runs: every function takes an axis, draws on it and returns it.

Needs the extras ``plot`` and, for the intervals, ``stats``.
"""

from qtab.plots.distribution import distribution
from qtab.plots.learning_curves import learning_curves
from qtab.plots.profile import profile
from qtab.plots.sensitivity import sensitivity

__all__ = ["distribution", "learning_curves", "profile", "sensitivity"]
