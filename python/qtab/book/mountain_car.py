"""Mountain Car with the book's tile coding (Example 10.1), as chapters 10 and 12 use it."""

from typing import Any

ENV = "MountainCar-v0"
"""Gymnasium's environment: the book's dynamics, a reward of -1 per step, the goal at 0.5."""

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
"""8 tilings of 8 x 8 tiles with asymmetric offsets. Initial values of zero are optimistic, so ε = 0 explores enough."""

UNSPECIFIED = (
    "how ties are broken (at random here), and what happens to an episode that does not end (truncated here). The "
    "book hashes its tiles; here they are not hashed"
)
"""The settings that the book states for none of these experiments."""
