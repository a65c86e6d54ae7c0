"""The settings of a run: what may be given, what it means, and what stands where nothing is given."""

from qtab.config.config import DEFAULTS, Config

__all__ = ["DEFAULTS", "Config"]
