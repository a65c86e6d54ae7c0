"""Small environments, each made to test one thing."""

from collections.abc import Callable, Iterable
from typing import Any

import gymnasium as gym
import numpy as np


class ScriptedEnv(gym.Env):
    """Shows the given observations in turn, whatever the actions are."""

    def __init__(
        self,
        observations: Iterable[Any],
        low: Any = 0.0,
        high: Any = 4.0,
        dtype: Any = np.float32,
        rewards: Iterable[Any] = (-1.0,),
        actions: gym.Space[Any] | None = None,
        length: int = 8,
        dimensions: int = 1,
    ) -> None:
        self.observation_space = gym.spaces.Box(low, high, (dimensions,), dtype)
        self.action_space = gym.spaces.Discrete(2) if actions is None else actions
        self.observations = list(observations)
        self.rewards = list(rewards)
        self.length = length
        self.steps = 0
        self.shown = 0
        self.taken: list[Any] = []
        self.seeds: list[Any] = []
        self.closed = False

    def _show(self) -> Any:
        observation = self.observations[self.shown % len(self.observations)]
        self.shown += 1
        return observation.copy() if isinstance(observation, np.ndarray) else observation

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        super().reset(seed=seed)
        self.seeds.append(seed)
        self.steps = 0
        return self._show(), {}

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        self.taken.append(action)
        self.steps += 1
        reward = self.rewards[len(self.taken) % len(self.rewards)]
        return self._show(), reward, self.steps >= self.length, False, {}

    def close(self) -> None:
        self.closed = True


class Walk(gym.Env):
    """A random walk on [0, 4] with rewards of many digits; it draws at resets and at every step."""

    def __init__(self, dtype: Any = np.float32, start: int = 0, actions: int = 3, shown: Any = None) -> None:
        self.observation_space = gym.spaces.Box(0.0, 4.0, (2,), dtype)
        self.action_space = gym.spaces.Discrete(actions, start=start)
        self.middle = start + 1
        self.dtype = dtype if shown is None else shown
        self.position = np.zeros(2)

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=seed)
        self.position = self.np_random.uniform(1.0, 3.0, 2)
        return self.position.astype(self.dtype), {}

    def step(self, action: int) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        assert self.action_space.contains(action)
        push = (action - self.middle) * np.array([0.5, -0.3])
        self.position = np.clip(self.position + push + self.np_random.uniform(-0.4, 0.4, 2), 0.0, 4.0)
        reward = float(-np.sum(self.position) / 3.0)
        return self.position.astype(self.dtype), reward, bool(self.position[0] >= 3.5), False, {}


class Calls(gym.Wrapper):
    """Calls a function before every step with the number of steps taken before."""

    def __init__(self, env: gym.Env, before: Callable[[int], Any]) -> None:
        super().__init__(env)
        self.before = before
        self.count = 0

    def step(self, action: Any) -> Any:
        self.count += 1
        self.before(self.count - 1)
        return self.env.step(action)


class Brittle(gym.Wrapper):
    """Fails in its second episode when its first came from seed 2."""

    bad = False

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        if seed is None and self.bad:
            raise RuntimeError("out of order")
        self.bad = seed == 2
        return self.env.reset(seed=seed, options=options)


def make_brittle() -> Brittle:
    return Brittle(gym.make("MountainCar-v0"))


def make_walk(**kwargs: Any) -> Walk:
    return Walk(**kwargs)


class Sampled(gym.Env):
    """Shows random observations of a space; rewards depend on the action."""

    def __init__(self, space: gym.Space[Any]) -> None:
        self.observation_space, self.action_space = space, gym.spaces.Discrete(3, start=2)

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        super().reset(seed=seed)
        if seed is not None:
            self.observation_space.seed(seed)
        return self.observation_space.sample(), {}

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        assert self.action_space.contains(action)
        return self.observation_space.sample(), float(action) / 7.0, bool(self.np_random.random() < 0.1), False, {}


class Chain(gym.Env[Any, Any]):
    """A state of one float64 number, varying rewards, and an action space that starts at 5."""

    observation_space = gym.spaces.Box(-2.0, 2.0, (1,), np.float64)
    action_space = gym.spaces.Discrete(3, start=5)

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.place = float(self.np_random.uniform(-0.5, 0.5))
        return np.array([self.place]), {}

    def step(self, action: int) -> Any:
        self.place += (action - 6) * 0.5 + float(self.np_random.uniform(-0.2, 0.2))
        over = abs(self.place) > 1.5
        self.place = min(max(self.place, -2.0), 2.0)
        return np.array([self.place]), self.place - 0.1, over, False, {}
