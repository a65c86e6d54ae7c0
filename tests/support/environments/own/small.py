"""Small environments whose transitions are known, as users write them."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class WindyGrid(qtab.FunctionalEnv):
    """A grid with four actions; with probability ``slip`` the step has a random direction. The state is the place."""

    action_space = gym.spaces.Discrete(4)

    def __init__(self, slip: float = 0.2, rows: int = 3, columns: int = 4) -> None:
        self.slip, self.rows, self.columns = slip, rows, columns
        self.observation_space = gym.spaces.MultiDiscrete([rows, columns])

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0, rng.integers(0, 2)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        if rng.random() < self.slip:
            action = int(rng.integers(0, 4))
        down, right = ((-1, 0), (0, 1), (1, 0), (0, -1))[action]
        row = min(max(state[0] + down, 0), self.rows - 1)
        column = min(max(state[1] + right, 0), self.columns - 1)
        done = (row, column) == (self.rows - 1, self.columns - 1)
        return (row, column), (10.0 if done else -1.0), done

    def observe(self, state: Any) -> Any:
        return state


class Gambler(qtab.FunctionalEnv):
    """The gambler's problem (Sutton & Barto, 2nd ed., example 4.3). The action is the stake, at least 1."""

    def __init__(self, goal: int = 20, heads: float = 0.4) -> None:
        self.goal, self.heads = goal, heads
        self.observation_space = gym.spaces.Discrete(goal + 1)
        self.action_space = gym.spaces.Discrete(goal // 2, start=1)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return self.goal // 4

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        stake = min(action, state, self.goal - state)
        state += stake if rng.random() < self.heads else -stake
        return state, float(state == self.goal), state in (0, self.goal)

    def observe(self, state: Any) -> Any:
        return state


class Pig(qtab.FunctionalEnv):
    """The dice game Pig against the clock: roll (0) or hold (1); a 1 loses the points of the turn.

    The state is the points held, the points of the turn and the turns left.
    """

    action_space = gym.spaces.Discrete(2)
    observation_space = gym.spaces.MultiDiscrete([16, 31, 4])

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0, 0, 3

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        held, turn, left = state
        if action == 1:
            held, turn, left = min(held + turn, 15), 0, left - 1
        else:
            die = rng.integers(1, 6, endpoint=True)
            turn, left = (0, left - 1) if die == 1 else (min(turn + die, 30), left)
        return (held, turn, left), (float(held) if left == 0 else 0.0), left == 0

    def observe(self, state: Any) -> Any:
        return state


class NoisyWalk(qtab.FunctionalEnv):
    """A walk on five places with a move that is a rounded normal number, whose outcomes the class lists."""

    action_space = gym.spaces.Discrete(2)
    observation_space = gym.spaces.Discrete(5)
    chances = (0.25, 0.5, 0.25)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 2 if rng.normal() < 0 else 1

    def initial_outcomes(self) -> Any:
        return [(0.5, 1), (0.5, 2)]

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        move = min(max(round(rng.normal()), -1), 1)
        return self._moved(state, action, move)

    def outcomes(self, state: Any, action: int) -> Any:
        return [
            (chance, *self._moved(state, action, move)) for chance, move in zip(self.chances, (-1, 0, 1), strict=True)
        ]

    def _moved(self, state: int, action: int, move: int) -> tuple[int, float, bool]:
        place = min(max(state + move + 2 * action - 1, 0), 4)
        return place, -1.0, place == 4

    def observe(self, state: Any) -> Any:
        return state


class Line(qtab.FunctionalEnv):
    """Places 0 to 4, of which the last ends the episode."""

    action_space: Any = gym.spaces.Discrete(2)
    observation_space = gym.spaces.Box(-np.inf, np.inf, (1,), np.float64)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        state = min(state + action, 4)
        return state, -1.0, state == 4

    def observe(self, state: Any) -> Any:
        return float(state)


def line(**methods: Any) -> Any:
    """A Line with other methods."""
    return type("Line", (Line,), methods)()
