"""Runs in compiled classes that are stopped within an episode."""

from typing import Any

import gymnasium as gym

import qtab
from support.environments.gym_classes.grids import CliffEnv
from support.processes.timer import stopped_by_a_timer


class Grows(gym.Env):
    """A product that needs more than 64 bits from one step of an episode on, which random actions do not reach."""

    observation_space = gym.spaces.Discrete(8)
    action_space = gym.spaces.Discrete(2)

    def __init__(self, fails_at: int = 3_000, length: int = 4_000) -> None:
        self.fails_at, self.length = fails_at, length

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.count = 0
        return 0, {}

    def step(self, action):
        self.count = self.count + 1
        draw = int(self.np_random.integers(0, 8))
        reward = float(draw)
        if self.count > self.fails_at:
            product = (self.count + 2**40) * (2**40 + self.count)
            reward = reward + product % 3
        return draw, reward, self.count == self.length, False, {}


def stopped(seconds: float, make: Any, **settings: Any) -> qtab.Run:
    """A run that was stopped as Ctrl-C stops it."""
    return stopped_by_a_timer(seconds, make(), KeyboardInterrupt, **settings)


def trained_until(finished: int, make: Any, run: qtab.Run | None = None, **settings: Any) -> qtab.Run:
    def stop(progress: qtab.Progress) -> bool:
        return progress.episodes < finished

    if run is not None:
        return qtab.resume(run, env=make(), callback=stop, callback_every=finished)
    return qtab.train(make(), callback=stop, callback_every=finished, **settings)


LONG: dict[str, Any] = {
    **{"episodes": 10**5, "max_episode_steps": 10**6, "seed": 2, "epsilon": 0.5, "backend": "numba"},
    "progress": False,
}


def windy() -> CliffEnv:
    return CliffEnv(wind=0.4)
