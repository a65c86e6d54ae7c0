"""A grid world like those of MiniGrid: a position, a direction, three actions."""

from typing import Any

import gymnasium as gym
import numpy as np

MAP = [
    "#######",
    "#  #  #",
    "#  #  #",
    "#     #",
    "#  #  #",
    "#  # G#",
    "#######",
]
LEFT, RIGHT, FORWARD = range(3)
MOVES = [(0, 1), (1, 0), (0, -1), (-1, 0)]
SHORTEST = 11
"""Steps on the shortest path: a turn, two down, a turn, four through the door, a turn, two down."""


class Room(gym.Env[Any, Any]):
    """Turn left, turn right or move forward; walls block, moves may slip, and the goal pays less the later.

    An observation is a row and a column, from 1 on, and a direction: a tuple, or an array where ``multi``.
    """

    metadata = {"render_modes": ["ansi"]}  # noqa: RUF012 - as Gymnasium declares it
    action_space = gym.spaces.Discrete(3)

    def __init__(self, slip: float = 0.0, multi: bool = False, render_mode: str | None = None) -> None:
        self.slip, self.multi, self.render_mode = slip, multi, render_mode
        self.observation_space: gym.Space[Any] = (
            gym.spaces.MultiDiscrete([5, 5, 4], start=[1, 1, 0])
            if multi
            else gym.spaces.Tuple(
                (gym.spaces.Discrete(5, start=1), gym.spaces.Discrete(5, start=1), gym.spaces.Discrete(4))
            )
        )

    def _observe(self) -> Any:
        seen = (*self.place, self.direction)
        return np.array(seen) if self.multi else seen

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.place, self.direction, self.steps = (1, 1), 0, 0
        if self.slip:
            self.direction = int(self.np_random.integers(4))
        return self._observe(), {}

    def step(self, action: int) -> Any:
        assert self.action_space.contains(action)
        self.steps += 1
        if self.slip and self.np_random.random() < self.slip:
            action = FORWARD
        if action == FORWARD:
            row, column = (position + move for position, move in zip(self.place, MOVES[self.direction], strict=True))
            if MAP[row][column] != "#":
                self.place = row, column
        else:
            self.direction = (self.direction + (1 if action == RIGHT else -1)) % 4
        goal = MAP[self.place[0]][self.place[1]] == "G"
        return self._observe(), 1.0 - 0.005 * self.steps if goal else 0.0, goal, False, {}

    def render(self) -> str:
        rows = [list(line) for line in MAP]
        rows[self.place[0]][self.place[1]] = ">v<^"[self.direction]
        return "\n".join(map("".join, rows))
