"""The examples of the playground as lessons, whose claims the modules here hold."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

import qtab
from qtab.envs.grid_worlds import grid_world
from qtab.playground import definitions

SEEDS = 16
"""How many seeds the page offers, from 0."""


@dataclass
class Episode:
    """An episode of the greedy policy, as the page plays it: it begins as the first one in training."""

    states: list[Any]
    total: float
    terminated: bool

    @property
    def steps(self) -> int:
        """The number of steps."""
        return len(self.states) - 1


@dataclass
class Lesson:
    """An example of the page."""

    environment: str
    settings: dict[str, Any]
    grid: dict[str, Any] | None

    def make(self) -> gym.Env[Any, Any]:
        """Makes its environment, without a time limit."""
        known = definitions()["environments"][self.environment]
        if known["python"]:
            return gym.make(known["python"], **known["env_kwargs"]).unwrapped
        assert self.grid is not None
        rewards = {(row, column): reward for row, column, reward in self.grid["rewards"]}
        earned = {name: self.grid[name] for name in ("wind", "step_reward", "goal_reward")}
        return grid_world(self.grid["layout"], rewards=rewards, **earned).unwrapped

    def arguments(self) -> dict[str, Any]:
        """Returns its settings as keywords."""
        known = definitions()["environments"][self.environment]
        settings = {name: tuple(value) if isinstance(value, list) else value for name, value in self.settings.items()}
        return {**settings, **({"env_kwargs": known["env_kwargs"]} if known["python"] else {})}

    @property
    def env(self) -> Any:
        """What ``qtab.train_many`` takes."""
        return definitions()["environments"][self.environment]["python"] or self.make

    def runs(self, seeds: int = SEEDS, **changes: Any) -> qtab.Runs:
        """Trains it with the page's seeds."""
        return qtab.train_many(self.env, seeds=range(seeds), tables=True, **{**self.arguments(), **changes})

    def train(self, seed: int, **arguments: Any) -> qtab.Run:
        """Trains it with one seed."""
        env = definitions()["environments"][self.environment]["python"] or self.make()
        return qtab.train(env, seed=seed, progress=False, **{**self.arguments(), **arguments})

    def greedy(self, run: qtab.Run, seed: int) -> Episode:
        """Plays the greedy policy."""
        env = self.make()
        observation, _ = env.reset(seed=seed)
        episode = Episode([observation], 0.0, terminated=False)
        while not episode.terminated and episode.steps < self.settings["max_episode_steps"]:
            action, _ = run.predict(observation)
            observation, reward, episode.terminated, _, _ = env.step(action)
            episode.states.append(observation)
            episode.total += float(reward)
        return episode

    def greedy_of_all(self, runs: qtab.Runs) -> list[Episode]:
        """Plays the greedy policy of each seed."""
        return [self.greedy(runs[seed], seed) for seed in range(len(runs.episode_returns))]


def last(runs: qtab.Runs) -> NDArray[np.float64]:
    """Returns the figure that the page shows for each seed: the mean return of the last episodes."""
    episodes = runs.episode_returns.shape[1]
    window = min(max(round(episodes / 5), 5), 100, episodes)
    means: NDArray[np.float64] = runs.episode_returns[:, -window:].mean(axis=1)
    return means


Lessons: TypeAlias = Mapping[tuple[str, str], Lesson]
"""The lessons by their environments and titles."""
Claims: TypeAlias = Mapping[tuple[str, str], Callable[[Lesson, Lessons], None]]
"""The claim of each example, by its environment and title: a function that asserts it."""
