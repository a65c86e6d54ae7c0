"""Pictures of runs: of a Run, of Runs, of a Sweep, of arrays, or of a mapping of names to any of these.

Of many runs: ``learning_curves``, ``distribution``, ``profile`` and ``sensitivity``. Of what was learned: ``values``,
``policy``, ``visits``, ``trajectory``, ``difference``, ``schedule``, and ``overview``, which returns a figure of four.

Every function draws on the axes it is given, or on a new figure, which a notebook and ``plt.show()`` show, and returns
the axes. They need the extra ``plot``; those with confidence intervals also need ``stats``.
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
