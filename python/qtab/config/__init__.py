"""The settings of a run: names, meanings, checks, defaults and presets."""

from qtab.config.config import DEFAULTS, Config

__all__ = ["DEFAULTS", "Config"]
