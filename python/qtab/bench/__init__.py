"""``qtab bench``: the speed of this package relative to Gymnasium, to NumPy loops and to numba, in one process."""

from qtab.bench.footprint import Footprint
from qtab.bench.report import Report, bench
from qtab.bench.timing import Timings, measure

__all__ = ["Footprint", "Report", "Timings", "bench", "measure"]
