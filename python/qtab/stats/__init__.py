"""Statistics of many runs, with confidence intervals: ``stats.iqm(runs.final_returns())``.

All functions take arrays of finite numbers, and an interval needs at least two of them. They need SciPy, which the
extra ``stats`` installs.
"""

from qtab._utils.extras import missing

try:
    import scipy  # noqa: F401
except ModuleNotFoundError as _error:
    raise missing(_error, "stats") from None

from qtab.stats.aggregates import AGGREGATES, aggregate, optimality_gap
from qtab.stats.comparisons import Comparison, compare
from qtab.stats.curves import area_under_curve, curve, episodes_to_threshold
from qtab.stats.improvement import probability_of_improvement
from qtab.stats.interval import Interval
from qtab.stats.intervals import iqm, mean, median, tolerance_interval
from qtab.stats.profiles import performance_profile, profile
from qtab.stats.rates import rate, solved_rate

__all__ = [
    "AGGREGATES",
    "Comparison",
    "Interval",
    "aggregate",
    "area_under_curve",
    "compare",
    "curve",
    "episodes_to_threshold",
    "iqm",
    "mean",
    "median",
    "optimality_gap",
    "performance_profile",
    "probability_of_improvement",
    "profile",
    "rate",
    "solved_rate",
    "tolerance_interval",
]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]
