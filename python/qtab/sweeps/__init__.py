"""Sweeps: many settings with many seeds each, kept in a store that survives interruption."""

from qtab.sweeps.database import StoreError
from qtab.sweeps.results import Sweep, load_sweep
from qtab.sweeps.sweep import SweepProgress, sweep

__all__ = ["StoreError", "Sweep", "SweepProgress", "load_sweep", "sweep"]
