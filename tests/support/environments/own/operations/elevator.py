"""An elevator and the calls on each floor."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class Elevator(qtab.FunctionalEnv):
    """The state is the floor and a boolean array of calls. The actions go down, stop and go up."""

    action_space = gym.spaces.Discrete(3)

    def __init__(self, floors: int = 5, rate: float = 0.15) -> None:
        self.floors, self.rate = floors, rate
        self.observation_space = gym.spaces.Dict(
            calls=gym.spaces.MultiBinary(floors), floor=gym.spaces.Discrete(floors)
        )

    def initial_state(self, rng: np.random.Generator) -> Any:
        return rng.integers(0, self.floors), np.zeros(self.floors, np.bool_)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        floor, calls = state[0], state[1].copy()
        served = 0
        if action == 1:
            served = 1 if calls[floor] else 0
            calls[floor] = False
        floor = min(max(floor + action - 1, 0), self.floors - 1)
        waiting = 0
        for other in range(self.floors):
            if rng.random() < self.rate:
                calls[other] = True
            if calls[other]:
                waiting += 1
        return (floor, calls), served - 0.2 * waiting, False

    def observe(self, state: Any) -> Any:
        return state[1], state[0]
