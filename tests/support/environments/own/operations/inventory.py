"""Inventory control with Poisson demand."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class Inventory(qtab.FunctionalEnv):
    """The state is the stock and the day. Orders cost a fixed amount and a price for each item."""

    observation_space = gym.spaces.Tuple((gym.spaces.Discrete(31), gym.spaces.Discrete(31)))
    action_space = gym.spaces.Discrete(11)

    def __init__(self, demand: float = 4.0, prices: tuple[float, float, float] = (2.0, 1.0, 3.0)) -> None:
        self.demand, self.prices = demand, prices

    def initial_state(self, rng: np.random.Generator) -> Any:
        return rng.integers(0, 10, endpoint=True), 0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        stock, day = state
        fixed, price, revenue = self.prices
        stock = min(stock + action, 30)
        sold = min(rng.poisson(self.demand), stock)
        cost = (fixed if action > 0 else 0.0) + price * action + 0.1 * stock
        return (stock - sold, day + 1), revenue * sold - cost, day + 1 == 30

    def observe(self, state: Any) -> Any:
        return state
