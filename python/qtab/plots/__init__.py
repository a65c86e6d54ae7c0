"""Pictures of a Run, Runs, a Sweep, arrays, or a mapping of names to any of these.

Many runs: ``learning_curves``, ``distribution``, ``profile`` and ``sensitivity``. The result of a run: ``values``,
``policy``, ``visits``, ``trajectory``, ``difference``, ``schedule``, and ``overview``, a figure with four of them.

Every function draws on the axes it is given, or on a new figure, which a notebook and ``plt.show()`` show, and returns
the axes. Plots need the extra ``plot``; those with confidence intervals also need ``stats``.
"""

from qtab.plots.difference import difference
from qtab.plots.distribution import distribution
from qtab.plots.learning_curves import learning_curves
from qtab.plots.overview import overview
from qtab.plots.policy import policy
from qtab.plots.profile import profile
from qtab.plots.schedule import schedule
from qtab.plots.sensitivity import sensitivity
from qtab.plots.trajectory import trajectory
from qtab.plots.values import values
from qtab.plots.visits import visits

__all__ = [
    "difference",
    "distribution",
    "learning_curves",
    "overview",
    "policy",
    "profile",
    "schedule",
    "sensitivity",
    "trajectory",
    "values",
    "visits",
]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]
