"""Sweeps: many settings, many seeds each, in a store that survives being killed."""

from qtab.sweeps.loading import load_sweep
from qtab.sweeps.results import Sweep
from qtab.sweeps.store import StoreError
from qtab.sweeps.sweep import SweepProgress, sweep

__all__ = ["StoreError", "Sweep", "SweepProgress", "load_sweep", "sweep"]
