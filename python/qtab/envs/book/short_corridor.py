"""``qtab/ShortCorridor-v0``: the short corridor with switched actions (Sutton & Barto, 2nd ed., Example 13.1)."""

from typing import Any

import gymnasium as gym

LEFT, RIGHT = range(2)
SWITCHED, GOAL = 1, 3


class ShortCorridorEnv(gym.Env[Any, Any]):
    """Three states in a row that all look alike, with the goal to the right of them; every step costs 1.

    Left and right move the agent as named, except in the second state, where they are switched; left in the first state
    does nothing. Since the observation is always 0, a deterministic policy never reaches the goal, and the best policy
    goes right with probability 2 - √2, about 0.586: its return is -6 - 4 √2, about -11.66, on average.
    """

    def __init__(self) -> None:
        self.observation_space = gym.spaces.Discrete(1)
        self.action_space = gym.spaces.Discrete(2)
        self.state = GOAL

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        """Starts an episode in the first state; no random number is drawn."""
        super().reset(seed=seed, options=options)
        self.state = 0
        return 0, {}

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        """Takes a step to the left (0) or to the right (1).

        Raises:
            AssertionError: for an action outside the space.
        """
        assert self.action_space.contains(action), f"{action!r} ({type(action)}) invalid"  # noqa: S101
        to_the_right = (action == RIGHT) != (self.state == SWITCHED)
        self.state = self.state + 1 if to_the_right else max(self.state - 1, 0)
        return 0, -1.0, self.state == GOAL, False, {}
