"""More classes that show a difference to Python: by info dicts, references, the method close and constructors."""

import itertools
import weakref
from typing import Any

import gymnasium as gym
from gymnasium import spaces

from support.environments.gym_classes.visible import CLOSED, MADE, Plain

LAST: dict[str, Any] = {}
"""A dict of the module."""
_count = itertools.count()


def make_plain() -> gym.Env:
    return Plain()


class InfoNumbers(Plain):
    """Its info dict has numbers, and a counter that nothing else reads."""

    def reset(self, *, seed=None, options=None):
        self.steps = 0
        return super().reset(seed=seed)

    def _get_info(self):
        """Returns the info dict."""
        return {"cell": self.cell, "left": 9 - self.cell, "is_right": self.cell > 4, "board": self.board.copy()}

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        self.steps += 1
        return cell, reward, terminated, False, {"steps": self.steps, "all": self._get_info()}


class InfoDivides(Plain):
    """A value of its info dict divides by zero in a state that is seldom reached."""

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        return cell, reward, terminated, False, {"rate": 1 / (999 - self.cell)}


class InfoUnset(Plain):
    """A value of its info dict is not set on every path."""

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        if self.cell < 999:
            extra = self.cell
        return cell, reward, terminated, False, {"extra": extra}


class InfoAttribute(Plain):
    """An attribute that no code reads may raise an error."""

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        self.rate = 1.0 / (999 - self.cell)
        return cell, reward, terminated, False, {}


class InfoShared(Plain):
    """Its info dict is one of the module."""

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        info = LAST
        info["cell"] = self.cell
        return cell, reward, terminated, False, info


class KeepsAttributes(Plain):
    """Its constructor keeps a reference to the dict of its attributes."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        MADE.append(vars(self))


class KeepsWeakly(Plain):
    """Its constructor keeps a weak reference to the object."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        MADE.append(weakref.ref(self))


class ClosesBySuper(Plain):
    """Its method close reads its state by super()."""

    def close(self):
        CLOSED.append(super().__getattribute__("__dict__").get("cell", -1))


class ClosesCounter(Plain):
    """Only its method close reads a counter."""

    def reset(self, *, seed=None, options=None):
        self.count = 0
        return super().reset(seed=seed)

    def step(self, action):
        self.count += 1
        return super().step(action)

    def close(self):
        CLOSED.append(self.count if MADE else -1)


class Counted(spaces.Discrete):
    """A space of one's own."""


class OwnSpace(Plain):
    """Its space is a class of one's own."""

    observation_space = Counted(10)


class CountsObjects(Plain):
    """The third object is another one."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        self.bonus = float(next(_count) > 1)


class DrawsLater(Plain):
    """Its constructor draws from its generator."""

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        self.bonus = float(self.np_random.random() < 1e-9)


class TakesLevels(Plain):
    """Its constructor takes a level from a list of the class."""

    levels = [0.0] * 1_000 + [1.0]

    def __init__(self, board: Any = None, render_mode: str | None = None) -> None:
        super().__init__(board, render_mode)
        self.bonus = self.levels.pop()
