"""Mountain Car as the book has it (Example 10.1), for its chapters 10 and 12."""

from typing import Any

ENV = "MountainCar-v0"
"""Gymnasium's: the book's dynamics, -1 a step, the goal at 0.5. The book has no time limit; the cap stands for none."""

TILE_CODING: dict[str, Any] = {
    "discretizer": "tiles",
    "tilings": 8,
    "tiles": 8,
    "low": (-1.2, -0.07),
    "high": (0.5, 0.07),
    "discount": 1.0,
    "epsilon": 0.0,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
}
"""8 tilings of 8 by 8 tiles with asymmetric offsets. Values of zero are optimistic: no exploration is needed."""

OPEN = (
    "how ties are broken (at random here), and what becomes of an episode that does not end (capped here). The book's "
    "tiles are hashed, ours are not"
)
"""What the book leaves open of all of them."""
