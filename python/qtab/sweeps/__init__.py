"""Sweeps: many settings with many seeds each, kept in a store that survives interruption."""

from qtab.sweeps.confirm import Confirmation
from qtab.sweeps.connection import StoreError
from qtab.sweeps.results import Sweep
from qtab.sweeps.sweep import load_sweep, sweep
from qtab.sweeps.training import SweepProgress

__all__ = ["Confirmation", "StoreError", "Sweep", "SweepProgress", "load_sweep", "sweep"]
