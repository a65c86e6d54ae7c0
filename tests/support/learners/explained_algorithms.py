"""The algorithms by how ``qtab.explain`` shows their updates."""

from qtab.config.choices import CHOICES
from qtab.config.options import AVERAGE_REWARD, MONTE_CARLO, PREFERENCES

PLANNED = ("prioritized_sweeping",)
"""All updates are planned."""
STEP_BY_STEP = tuple(
    name for name in CHOICES["algorithm"] if name not in (*MONTE_CARLO, *AVERAGE_REWARD, *PREFERENCES, *PLANNED)
)
"""Every step has an update of action values: its own, or one that waited for it."""
WITH_TILES = tuple(name for name in PREFERENCES if name != "gradient_bandit")
"""Policy gradient methods, whose episodes can be repeated from their start."""
