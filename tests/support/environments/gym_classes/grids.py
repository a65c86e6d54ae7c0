"""Grid worlds in the styles of tutorials."""

from enum import Enum, IntEnum
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

MAZE = [
    "#########",
    "#S..#...#",
    "#.#.#.#.#",
    "#.#...#G#",
    "#########",
]
UP, RIGHT, DOWN, LEFT = range(4)
MOVES = {UP: (-1, 0), RIGHT: (0, 1), DOWN: (1, 0), LEFT: (0, -1)}


class Actions(Enum):
    RIGHT = 0
    UP = 1
    LEFT = 2
    DOWN = 3


class GridWorldEnv(gym.Env):
    """The environment of Gymnasium's documentation."""

    metadata = {"render_modes": ["human", "rgb_array"], "render_fps": 4}  # noqa: RUF012

    def __init__(self, render_mode: str | None = None, size: int = 5) -> None:
        self.size = size
        self.window_size = 512
        self.observation_space = spaces.Dict(
            {
                "agent": spaces.Box(0, size - 1, shape=(2,), dtype=int),
                "target": spaces.Box(0, size - 1, shape=(2,), dtype=int),
            }
        )
        self.action_space = spaces.Discrete(4)
        self._action_to_direction = {
            Actions.RIGHT.value: np.array([1, 0]),
            Actions.UP.value: np.array([0, 1]),
            Actions.LEFT.value: np.array([-1, 0]),
            Actions.DOWN.value: np.array([0, -1]),
        }
        assert render_mode is None or render_mode in self.metadata["render_modes"]
        self.render_mode = render_mode
        self.window: Any = None
        self.clock = None

    def _get_obs(self):
        return {"agent": self._agent_location, "target": self._target_location}

    def _get_info(self):
        return {"distance": np.linalg.norm(self._agent_location - self._target_location, ord=1)}

    def reset(self, seed=None, options=None):
        super().reset(seed=seed)
        self._agent_location = self.np_random.integers(0, self.size, size=2, dtype=int)
        self._target_location = self._agent_location
        while np.array_equal(self._target_location, self._agent_location):
            self._target_location = self.np_random.integers(0, self.size, size=2, dtype=int)
        observation = self._get_obs()
        info = self._get_info()
        if self.render_mode == "human":
            self._render_frame()
        return observation, info

    def step(self, action):
        direction = self._action_to_direction[action]
        self._agent_location = np.clip(self._agent_location + direction, 0, self.size - 1)
        terminated = np.array_equal(self._agent_location, self._target_location)
        reward = 1 if terminated else 0
        observation = self._get_obs()
        info = self._get_info()
        if self.render_mode == "human":
            self._render_frame()
        return observation, reward, terminated, False, info

    def render(self):
        if self.render_mode == "rgb_array":
            return self._render_frame()
        return None

    def _render_frame(self):
        import pygame

        if self.window is None and self.render_mode == "human":
            self.window = pygame.display.set_mode((self.window_size, self.window_size))


class CliffEnv(gym.Env):
    """A cliff walk with tuples for positions, a set of cliffs, and a wind that may push."""

    def __init__(self, shape: tuple[int, int] = (4, 12), wind: float = 0.1) -> None:
        super().__init__()
        self.shape = shape
        self.wind = wind
        self.start = (shape[0] - 1, 0)
        self.goal = (shape[0] - 1, shape[1] - 1)
        self.cliff = {(shape[0] - 1, column) for column in range(1, shape[1] - 1)}
        self.observation_space = spaces.Discrete(shape[0] * shape[1])
        self.action_space = spaces.Discrete(4)
        self.position = self.start

    def _to_state(self, position):
        row, column = position
        return row * self.shape[1] + column

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        super().reset(seed=seed, options=options)
        self.position = self.start
        return self._to_state(self.position), {"prob": 1.0}

    def step(self, action):
        assert self.action_space.contains(action), f"{action!r} invalid"
        if self.np_random.random() < self.wind:
            action = DOWN
        row_change, column_change = MOVES[action]
        row = min(max(self.position[0] + row_change, 0), self.shape[0] - 1)
        column = min(max(self.position[1] + column_change, 0), self.shape[1] - 1)
        self.position = (row, column)
        reward = -1
        if self.position in self.cliff:
            self.position = self.start
            reward = -100
        terminated = self.position == self.goal
        return self._to_state(self.position), reward, terminated, False, {"prob": 1.0}


class MazeEnv(gym.Env):
    """A maze in an array, with a list for the position and visited cells."""

    def __init__(self, maze: list[str] | None = None) -> None:
        rows = maze or MAZE
        self.walls = np.array([[cell == "#" for cell in row] for row in rows])
        self.height, self.width = self.walls.shape
        self.start = next((r, row.index("S")) for r, row in enumerate(rows) if "S" in row)
        self.goal = next((r, row.index("G")) for r, row in enumerate(rows) if "G" in row)
        self.visited = np.zeros((self.height, self.width), dtype=bool)
        self.observation_space = spaces.MultiDiscrete([self.height, self.width])
        self.action_space = spaces.Discrete(4)
        self.steps = 0

    def reset(self, seed=None, options=None):
        super().reset(seed=seed)
        self.position = [self.start[0], self.start[1]]
        self.visited[:] = False
        self.visited[self.start] = True
        self.steps = 0
        return np.array(self.position), {}

    def step(self, action):
        self.steps += 1
        row, column = self.position
        if action == UP:
            row -= 1
        elif action == DOWN:
            row += 1
        elif action == LEFT:
            column -= 1
        else:
            column += 1
        reward = -0.01
        if not self.walls[row, column]:
            self.position[0] = row
            self.position[1] = column
            if not self.visited[row, column]:
                reward += 0.05
            self.visited[row, column] = True
        else:
            reward -= 0.04
        done = tuple(self.position) == self.goal
        if done:
            reward = 1.0
        return np.array(self.position), reward, done, self.steps >= 60, {"visited": int(self.visited.sum())}


class Tile(IntEnum):
    FLOOR = 0
    LAVA = 1
    KEY = 2
    DOOR = 3


class KeyDoorEnv(gym.Env):
    """A grid that changes: a key to take, a door to open, lava; with properties and static methods."""

    DIRECTIONS = ((0, 1), (1, 0), (0, -1), (-1, 0))

    def __init__(self, size: int = 6, lava: int = 3) -> None:
        self.size, self.lava = size, lava
        self.grid = np.zeros((size, size), dtype=np.int8)
        self.observation_space = spaces.Tuple((spaces.Discrete(size), spaces.Discrete(size), spaces.Discrete(2)))
        self.action_space = spaces.Discrete(5)
        self.has_key = False

    @property
    def is_at_door(self) -> bool:
        return self.grid[self.row, self.column] == Tile.DOOR

    @staticmethod
    def clipped(value, low, high):
        return max(low, min(value, high))

    def _observe(self):
        return self.row, self.column, int(self.has_key)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.grid = np.zeros((self.size, self.size), dtype=np.int8)
        for _ in range(self.lava):
            row, column = self.np_random.integers(1, self.size - 1, size=2)
            self.grid[row, column] = Tile.LAVA
        self.grid[0, self.size - 1] = Tile.KEY
        self.grid[self.size - 1, self.size - 1] = Tile.DOOR
        self.row, self.column = 0, 0
        self.has_key = False
        self.elapsed = 0
        return self._observe(), {}

    def step(self, action):
        self.elapsed += 1
        reward, terminated = -0.1, False
        if action < 4:
            dr, dc = self.DIRECTIONS[action]
            self.row = self.clipped(self.row + dr, 0, self.size - 1)
            self.column = self.clipped(self.column + dc, 0, self.size - 1)
            if self.grid[self.row, self.column] == Tile.LAVA:
                reward, terminated = -5.0, True
        elif self.grid[self.row, self.column] == Tile.KEY and not self.has_key:
            self.has_key = True
            self.grid[self.row, self.column] = Tile.FLOOR
            reward = 1.0
        elif self.is_at_door and self.has_key:
            reward, terminated = 10.0, True
        return self._observe(), reward, terminated, self.elapsed >= 100, {"has_key": self.has_key}


class MaskedGridEnv(gym.Env):
    """A grid that forbids moves into its border, with masks in the info dict."""

    def __init__(self, size: int = 4) -> None:
        self.size = size
        self.observation_space = spaces.Discrete(size * size)
        self.action_space = spaces.Discrete(4)

    def _mask(self):
        mask = np.ones(4, dtype=np.int8)
        if self.row == 0:
            mask[0] = 0
        if self.row == self.size - 1:
            mask[1] = 0
        if self.column == 0:
            mask[2] = 0
        if self.column == self.size - 1:
            mask[3] = 0
        return mask

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.row = int(self.np_random.integers(self.size - 1))
        self.column = int(self.np_random.integers(self.size))
        return self.row * self.size + self.column, {"action_mask": self._mask()}

    def step(self, action):
        match action:
            case 0:
                self.row = max(self.row - 1, 0)
            case 1:
                self.row = min(self.row + 1, self.size - 1)
            case 2:
                self.column = max(self.column - 1, 0)
            case _:
                self.column = min(self.column + 1, self.size - 1)
        terminated = self.row == self.size - 1 and self.column == self.size - 1
        info = {"action_mask": self._mask()}
        return self.row * self.size + self.column, float(terminated), terminated, False, info
