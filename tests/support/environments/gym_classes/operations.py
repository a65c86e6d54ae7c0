"""Operations: stores, queues, elevators, machines, markets."""

from collections import namedtuple
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

Order = namedtuple("Order", "size cost")
DEMAND = np.array([0.2, 0.3, 0.3, 0.15, 0.05])


class InventoryEnv(gym.Env):
    """Orders goods against Poisson demand; keyword arguments with defaults, and a named tuple."""

    ORDERS = (Order(0, 0.0), Order(5, 6.0), Order(10, 11.0))

    def __init__(self, capacity: int = 20, demand: float = 4.0, **kwargs: Any) -> None:
        super().__init__()
        self.capacity = capacity
        self.demand = demand
        self.holding_cost = kwargs.get("holding_cost", 0.1)
        self.observation_space = spaces.Discrete(capacity + 1)
        self.action_space = spaces.Discrete(len(self.ORDERS))

    def reset(self, seed=None, options=None, **kwargs):
        super().reset(seed=seed)
        self.stock: int = self.capacity // 2
        self.day = 0
        self.total = 0.0
        return self.stock, {"day": self.day}

    def _sell(self, wanted, *, price=2.0, penalty=0.5):
        sold = min(self.stock, wanted)
        self.stock -= sold
        return price * sold - penalty * (wanted - sold)

    def step(self, action):
        order = self.ORDERS[action]
        self.stock = min(self.stock + order[0], self.capacity)
        wanted = self.np_random.poisson(self.demand)
        reward = self._sell(wanted, penalty=0.75) - order[1] - self.holding_cost * self.stock
        self.total += reward
        self.day += 1
        truncated = self.day >= 30
        info: dict[str, Any] = {"day": self.day}
        if truncated:
            info["total"] = self.total
        return self.stock, reward, False, truncated, info


class QueueEnv(gym.Env):
    """A queue of customers with priorities in an array that shifts; loops over ranges and slices."""

    def __init__(self, length: int = 5, priorities: int = 3) -> None:
        self.length, self.priorities = length, priorities
        self.queue = np.zeros(length, dtype=np.int64)
        self.observation_space = spaces.Box(0, priorities, (length + 1,), dtype=np.int64)
        self.action_space = spaces.Discrete(2)

    def _observation(self):
        observation = np.zeros(self.length + 1, dtype=np.int64)
        observation[:-1] = self.queue
        observation[-1] = self.servers
        return observation

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.queue = self.np_random.integers(1, self.priorities + 1, size=self.length)
        self.servers = 3
        self.elapsed = 0
        return self._observation(), {}

    def step(self, action):
        reward = 0.0
        first = self.queue[0]
        if action == 1 and self.servers > 0:
            self.servers -= 1
            reward += 2.0**2 if first == 3 else float(first)
        for i in range(self.length - 1):
            self.queue[i] = self.queue[i + 1]
        self.queue[self.length - 1] = self.np_random.integers(1, self.priorities, endpoint=True)
        for _ in range(3 - self.servers):
            if self.np_random.random() < 0.3:
                self.servers += 1
                continue
            reward -= 0.1
        self.elapsed += 1
        return self._observation(), reward, False, self.elapsed == 50, {}


class ElevatorEnv(gym.Env):
    """An elevator with calls in an array of booleans, several helpers, and a reward of several terms."""

    STAY, GO_UP, GO_DOWN, OPEN = 0, 1, 2, 3

    def __init__(self, floors: int = 6) -> None:
        self.floors = floors
        self.observation_space = spaces.Dict(
            {
                "floor": spaces.Discrete(floors),
                "calls": spaces.MultiBinary(floors),
                "load": spaces.Box(0.0, 1.0, (1,), dtype=np.float32),
            }
        )
        self.action_space = spaces.Discrete(4)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.floor = 0
        self.calls = np.zeros(self.floors, dtype=np.int8)
        self.load = np.zeros(1, dtype=np.float32)
        self.elapsed = 0
        self._spawn(chance=0.9)
        return self._obs(), self._info()

    def _spawn(self, chance=0.2):
        if self.np_random.uniform() < chance:
            self.calls[self.np_random.integers(self.floors)] = 1

    def _obs(self):
        return dict(floor=self.floor, calls=self.calls.copy(), load=self.load.copy())  # noqa: C408

    def _info(self):
        return {"waiting": int(np.sum(self.calls)), "text": f"floor {self.floor}"}

    def step(self, action):
        waiting = sum([int(self.calls[i]) for i in range(self.floors)])
        reward = -0.1 * waiting
        if action == self.GO_UP and self.floor < self.floors - 1:
            self.floor += 1
        elif action == self.GO_DOWN and self.floor > 0:
            self.floor -= 1
        elif action == self.OPEN and self.calls[self.floor]:
            self.calls[self.floor] = 0
            self.load[0] = self.floor / self.floors
            reward += 1
        self._spawn()
        self.elapsed += 1
        return self._obs(), reward, False, self.elapsed >= 80, self._info()


class MachineEnv(gym.Env):
    """A machine that wears out; rates in a nested list, a draw by choice with probabilities."""

    RATES = [[0.9, 0.1, 0.0], [0.0, 0.7, 0.3], [0.0, 0.0, 1.0]]  # noqa: RUF012
    COSTS = {"good": 0.0, "worn": 1.5, "broken": 8.0}  # noqa: RUF012
    NAMES = ("good", "worn", "broken")

    def __init__(self) -> None:
        self.rates = np.array(self.RATES)
        self.costs = np.array([self.COSTS[name] for name in self.NAMES])
        self.observation_space = spaces.Discrete(3)
        self.action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.condition = 0
        self.age = 0
        return self.condition, {}

    def step(self, action):
        if action:
            self.condition, reward = 0, -4.0
        else:
            draw = self.np_random.random()
            total = 0.0
            following = self.condition
            for state in range(3):
                total += self.rates[self.condition, state]
                if draw < total:
                    following = state
                    break
            self.condition = following
            reward = -self.costs[self.condition]
        self.age += self.np_random.choice(5, p=DEMAND)
        demand = self.np_random.choice([1, 2, 4])
        return self.condition, reward + 0.5 * demand, self.age > 60, False, {}


class TradingEnv(gym.Env):
    """Buys and sells on a path of prices made in __init__, with a window of past returns."""

    metadata = {"render_modes": []}  # noqa: RUF012

    def __init__(self, days: int = 120, window: int = 4, fee: float = 0.001) -> None:
        rng = np.random.default_rng(3)
        self.prices = 100 * np.exp(np.cumsum(rng.normal(0, 0.01, days)))
        self.returns = np.diff(self.prices, prepend=self.prices[0]) / self.prices
        self.window, self.fee = window, fee
        self.observation_space = spaces.Box(-np.inf, np.inf, (window + 1,), np.float64)
        self.action_space = spaces.Discrete(3)
        self.history: list[float] = []

    def _state(self):
        return np.concatenate([self.returns[self.t - self.window : self.t], [self.position]])

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.t = self.window + self.np_random.integers(0, 20)
        self.cash, self.position, self.entry = 1000.0, 0.0, 0.0
        return self._state(), {}

    @property
    def price(self):
        return self.prices[self.t]

    def step(self, action):
        before = self.cash + self.position * self.price
        if action == 1 and self.position == 0.0:
            self.position = self.cash / (self.price * (1 + self.fee))
            self.cash = 0.0
        elif action == 2 and self.position > 0:
            self.cash += self.position * self.price * (1 - self.fee)
            self.position = 0.0
        self.t += 1
        after = self.cash + self.position * self.price
        return self._state(), after - before, False, self.t >= len(self.prices) - 1, {"worth": after}
