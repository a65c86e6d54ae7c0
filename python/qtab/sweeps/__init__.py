"""Sweeps: many settings with many seeds each, kept in a store that survives interruption."""

from qtab.sweeps.confirm import Confirmation
from qtab.sweeps.connection import StoreError
from qtab.sweeps.load import load_sweep
from qtab.sweeps.progress import SweepProgress
from qtab.sweeps.results import Sweep
from qtab.sweeps.sweep import sweep

__all__ = ["Confirmation", "StoreError", "Sweep", "SweepProgress", "load_sweep", "sweep"]
