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


class Tutorial(gym.Env):
    """The grid world of Gymnasium's page "Create a custom environment", written from its description.

    An agent and a target are at different cells of a square; the observation is a Dict of their two positions. Actions
    0 to 3 move right, up, left and down. Reaching the target gives a reward of 1 and ends the episode.
    """

    MOVES = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])

    def __init__(self, size: int = 5) -> None:
        self.size = size
        integer: Any = int
        cell = gym.spaces.Box(0, size - 1, shape=(2,), dtype=integer)
        self.observation_space = gym.spaces.Dict({"agent": cell, "target": cell})
        self.action_space = gym.spaces.Discrete(4)
        self.agent = self.target = np.array([-1, -1])

    def _observation(self) -> dict[str, Any]:
        return {"agent": self.agent, "target": self.target}

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.agent = self.target = self.np_random.integers(0, self.size, size=2)
        while np.array_equal(self.agent, self.target):
            self.target = self.np_random.integers(0, self.size, size=2)
        return self._observation(), {"distance": int(np.abs(self.agent - self.target).sum())}

    def step(self, action: int) -> Any:
        self.agent = np.clip(self.agent + self.MOVES[action], 0, self.size - 1)
        arrived = np.array_equal(self.agent, self.target)
        return self._observation(), float(arrived), arrived, False, {}


class StoppedError(Exception):
    """What stops a run."""


class StoppingRoom(Room):
    """Fails at one of its steps, or at one of its resets, as an environment that Ctrl-C interrupts does."""

    def __init__(self, steps: int = 10**6, resets: int = 10**6) -> None:
        super().__init__()
        self.steps_left, self.resets_left = steps, resets

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        self.resets_left -= 1
        if not self.resets_left:
            raise StoppedError
        return super().reset(seed=seed, options=options)

    def step(self, action: int) -> Any:
        self.steps_left -= 1
        if not self.steps_left:
            raise StoppedError
        return super().step(action)
