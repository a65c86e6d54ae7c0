"""Sweeps: many settings, many seeds each, in a store that survives being killed."""

from qtab.sweeping.results import Sweep
from qtab.sweeping.run import SweepProgress, sweep
from qtab.sweeping.store import StoreError

__all__ = ["StoreError", "Sweep", "SweepProgress", "sweep"]
