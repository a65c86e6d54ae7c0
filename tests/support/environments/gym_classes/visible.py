"""Classes that compiled code would step with the same numbers, and that show a difference to Python elsewhere."""

import functools
import warnings
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import logger, spaces

CLOSED: list[int] = []
"""The cells in which environments were closed."""
MADE: list[Any] = []
"""The environments that keep a reference to themselves, or to their attributes."""


class Plain(gym.Env):
    """A walk over ten cells."""

    observation_space: Any = spaces.Discrete(10)
    action_space: Any = spaces.Discrete(2)
    slip = 0.1

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        self.render_mode = render_mode
        self.board = np.zeros(10) if board is None else board

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        self.board[:] = 0.0
        return self.cell, {}

    def step(self, action):
        if self.np_random.random() >= self.slip:
            self.cell = min(self.cell + 1, 9) if action == 1 else max(self.cell - 1, 0)
        self.board[self.cell] += 1.0
        return self.cell, -self.board[self.cell], self.cell == 9, False, {}


class Logs(Plain):
    """Writes a message of Gymnasium's logger."""

    def step(self, action):
        result = super().step(action)
        if self.cell == 5:
            logger.warn("the middle of the walk")
        return result


class ComputedSpace(Plain):
    """Its observation space is a property."""

    @property
    def observation_space(self):
        return spaces.Discrete(10)

    @observation_space.setter
    def observation_space(self, space):
        raise AttributeError("observation_space")


class Closes(Plain):
    """Reads its state when it is closed."""

    def close(self):
        CLOSED.append(self.cell if hasattr(self, "cell") else -1)


class ClosesWindow(Plain):
    """Its method close reads only what no step changes."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        self.window = None

    def close(self):
        if self.window is not None:
            raise AssertionError("there is no window")
        super().close()


class Registers(Plain):
    """Its constructor keeps a reference to the object."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        MADE.append(self)


class Cycle(Plain):
    """An attribute refers to the object."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        self.draw = functools.partial(print, self)


class Overflows(Plain):
    """NumPy warns of its rewards."""

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        large = np.float64(1e308) * (self.board[self.cell] + 1.0)
        return cell, reward + 0.0 * (large > 0), terminated, False, {}


class FloatCells(Plain):
    """Returns observations of the wrong type, which Python stepping refuses."""

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        return float(cell), reward, terminated, False, {}


class Cached(Plain):
    """A decorator stores results."""

    @functools.cache  # noqa: B019 - the subject of the test
    def _bonus(self, cell):
        return float(cell)

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        return cell, reward + self._bonus(cell), terminated, False, {}


class Delegates(Plain):
    """Looks attributes up by a method."""

    def __getattr__(self, name):
        if name == "bonus":
            return 1.0
        raise AttributeError(name)

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        return cell, reward + self.bonus, terminated, False, {}


class Counts(Plain):
    """Counts the steps of all episodes."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        self.count = 0

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        self.count += 1
        return cell, reward - self.count % 3, terminated, False, {}


class SecondGenerator(Plain):
    """Draws from a generator of its own."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        self.other = np.random.default_rng(0)

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        return cell, reward + self.other.random(), terminated, False, {}


class ReplacesGenerator(Plain):
    """Replaces its generator in reset."""

    def reset(self, *, seed=None, options=None):
        result = super().reset(seed=seed)
        self.np_random = np.random.default_rng(7)
        return result


class ReplacesSpace(Plain):
    """Replaces its space in reset."""

    def reset(self, *, seed=None, options=None):
        result = super().reset(seed=seed)
        self.observation_space = spaces.Discrete(10)
        return result


class ChangesSpace(Plain):
    """Changes its space in step."""

    def step(self, action):
        result = super().step(action)
        self.action_space.n = 2
        return result


class Warns(Plain):
    """Warns in a step."""

    def step(self, action):
        result = super().step(action)
        if self.cell == 5:
            warnings.warn("the middle of the walk", stacklevel=2)
        return result


class ChangesClass(Plain):
    """Changes an attribute of its class."""

    def step(self, action):
        type(self).slip = 0.2
        return super().step(action)


class IntegerFlags(Plain):
    """Returns an integer as terminated, which is seldom neither 0 nor 1."""

    def step(self, action):
        cell, reward, _, _, _ = super().step(action)
        return cell, reward, 2 * (cell == 9), False, {}


class RandomBoard(Plain):
    """Each object is another one."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        self.bonus = float(np.random.random())  # noqa: NPY002 - the subject of the test

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        return cell, reward + self.bonus, terminated, False, {}
