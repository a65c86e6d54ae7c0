"""Statistics of many runs, with confidence intervals: ``stats.iqm(runs.final_returns())``.

All functions take arrays. They need SciPy, which the extra ``stats`` installs.
"""

from qtab._utils.extras import missing

try:
    import scipy  # noqa: F401
except ModuleNotFoundError as _error:
    raise missing(_error, "stats") from None

from qtab.stats.aggregates import AGGREGATES, aggregate, optimality_gap, performance_profile
from qtab.stats.comparisons import Comparison, compare
from qtab.stats.curves import area_under_curve, curve, episodes_to_threshold
from qtab.stats.intervals import Interval, iqm, mean, median, tolerance_interval
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
    "rate",
    "solved_rate",
    "tolerance_interval",
]
