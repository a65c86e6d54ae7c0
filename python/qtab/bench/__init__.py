"""How fast: this package beside Gymnasium and the article's loop, in one process, as ratios."""

from qtab.bench.footprint import Footprint
from qtab.bench.report import Report, bench
from qtab.bench.rounds import Timings, measure

__all__ = ["Footprint", "Report", "Timings", "bench", "measure"]
