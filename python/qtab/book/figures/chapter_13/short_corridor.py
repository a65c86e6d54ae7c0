"""The settings of the experiments of chapter 13: the short corridor with switched actions."""

import math
from typing import Any

ENV = "qtab/ShortCorridor-v0"
BEST_RETURN = -6.0 - 4.0 * math.sqrt(2.0)
"""The return of the best policy, which goes right with probability 2 - √2."""
MAX_EPISODE_STEPS = 1_000
"""The time limit: a policy that has become almost deterministic would hardly ever end an episode."""
RUNS = 1_000
BOOK_RUNS = "100 runs of 1,000 episodes (1,000 runs here, as a few stuck runs dominate the mean of 100)"
UNSPECIFIED = "the initial policy (right with probability 0.05 here, as the returns of the book's first episodes show)"


def reinforce(log_alpha: int, **settings: Any) -> dict[str, Any]:
    """Returns the keyword arguments of :func:`qtab.train` for REINFORCE with a step size of ``2**log_alpha``."""
    return {"preset": "book", "learning_rate": 2.0**log_alpha, "episodes": 1000, **settings}
