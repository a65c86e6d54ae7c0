"""Plots of many runs: of Runs, of a Sweep, of arrays, or of a mapping of names to any of these.

Every function draws on the axes it is given, or on a new figure, which a notebook and ``plt.show()`` show, and returns
the axes. They need the extra ``plot``; those with confidence intervals also need ``stats``.
"""

from qtab.plots.distribution import distribution
from qtab.plots.learning_curves import learning_curves
from qtab.plots.profile import profile
from qtab.plots.sensitivity import sensitivity

__all__ = ["distribution", "learning_curves", "profile", "sensitivity"]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]
