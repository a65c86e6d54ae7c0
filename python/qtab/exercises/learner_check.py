"""Checks of learners: a few episodes in an environment, whose tables are compared after each step."""

from collections.abc import Callable, Mapping
from contextlib import closing
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.fields import with_fields
from qtab.config import Config
from qtab.envs.metadata.quantities import quantities_of
from qtab.exercises.exercise import Solution, parameters
from qtab.exercises.guard import guarded
from qtab.exercises.record import Misuse, Record
from qtab.exercises.recording_env import RecordingEnv
from qtab.reference.parts.discretizers import TileCoding
from qtab.reference.parts.streams import agent_stream

SAMPLES = "it calls env.action_space.sample(), which uses a separate generator: draw all random numbers from rng"


@with_fields
@dataclass(frozen=True)
class LearnerCheck:
    """A check of an exercise: lets a learner learn for a few episodes, and compares its table after each step."""

    title: str
    """The settings, in a few words."""
    model: Solution
    """The function of the reference, as in the exercise. Its parameters are among ``env``, the name of the table,
    ``episodes``, ``rng`` and the names of ``settings``."""
    env_id: str
    """Gymnasium's id of an environment with Discrete observations and actions."""
    episodes: int
    """The number of episodes."""
    max_episode_steps: int
    """The time limit of an episode, in steps."""
    settings: Mapping[str, Any] = field(default_factory=dict)
    """The learning rate, the discount and the others, by the names of the parameters."""
    table: str = "q"
    """The name of the array that the learner changes: ``q``, (states, actions), or ``values``, (states,)."""
    spread: float = 0.0
    """The initial values lie between minus this number and this number."""
    seed: int = 0
    """The seed of the environment, of ``rng`` and of the initial values."""

    @property
    def changes(self) -> tuple[str, ...]:
        """The name of the array that the learner changes."""
        return (self.table,)

    def run(self, function: Solution, record: Record, seconds: float) -> None:
        """Calls a learner, and records its tables, draws and actions.

        :meta private:
        """
        with closing(gym.make(self.env_id, max_episode_steps=self.max_episode_steps)) as env:
            rng: Any = agent_stream(self.seed, "PCG64")
            names = parameters(self.model)
            table = np.random.default_rng(self.seed).uniform(-self.spread, self.spread, self.shape(env))
            used_rng = rng if "rng" in names else None
            known = quantities_of(self.env_id)
            recording = RecordingEnv(env, known, self.seed, self.episodes, {self.table: table}, used_rng, record)
            given: dict[str, Any] = {
                "env": recording,
                self.table: table,
                "episodes": self.episodes,
                "rng": rng,
                **self.settings,
                **self.own_arguments(env),
            }
            fixed = {
                name: value.copy()
                for name, value in given.items()
                if isinstance(value, np.ndarray) and name != self.table
            }
            space: Any = env.action_space
            space.seed(self.seed)
            before_sampling = deepcopy(space.np_random.bit_generator.state)
            try:
                guarded(function, {name: given[name] for name in names}, record, seconds)
                recording.finish()
            finally:
                if space.np_random.bit_generator.state != before_sampling:
                    record.faults.append(SAMPLES)
            for name, before in fixed.items():
                if not np.array_equal(before, given[name]):
                    raise Misuse(f"it changes its argument {name}: work on a copy, {name}.copy()")

    def shape(self, env: gym.Env) -> tuple[int, ...]:
        """Returns the shape of the table."""
        return self.states(env), int(env.action_space.n)  # type: ignore[attr-defined]

    def states(self, env: gym.Env) -> int:
        """Returns the number of rows of the table."""
        return int(env.observation_space.n)  # type: ignore[attr-defined]

    def own_arguments(self, env: gym.Env) -> Mapping[str, Any]:  # noqa: ARG002
        """Returns the arguments that only this kind of learner takes."""
        return {}


@dataclass(frozen=True)
class PredictionCheck(LearnerCheck):
    """Lets a learner estimate the values of a policy."""

    table: str = "values"

    def shape(self, env: gym.Env) -> tuple[int, ...]:
        """Returns the shape of the values."""
        return (self.states(env),)

    def own_arguments(self, env: gym.Env) -> Mapping[str, Any]:
        """Returns the policy: an action for each state."""
        space: Any = env.action_space
        return {"policy": np.random.default_rng(self.seed + 1).integers(int(space.n), size=self.states(env))}


@dataclass(frozen=True)
class FeatureCheck(LearnerCheck):
    """Lets a learner with linear function approximation learn on tiles."""

    table: str = "w"
    tilings: int = 4
    tiles: tuple[int, ...] = (2, 2, 2, 2)
    low: tuple[float, ...] = (-2.4, -2.0, -0.21, -2.0)
    high: tuple[float, ...] = (2.4, 2.0, 0.21, 2.0)

    def states(self, env: gym.Env) -> int:
        """Returns the number of features."""
        return self._tiles(env).shape[0]

    def own_arguments(self, env: gym.Env) -> Mapping[str, Any]:
        """Returns the function from an observation to its active features."""
        coding = self._tiles(env)
        features: Callable[[Any], NDArray[np.int64]] = lambda observation: np.array(coding.rows(observation))  # noqa: E731
        return {"features": features}

    def _tiles(self, env: gym.Env) -> TileCoding:
        space: Any = env.observation_space
        tiles: dict[str, Any] = {name: getattr(self, name) for name in ("tilings", "tiles", "low", "high")}
        return TileCoding(space, Config(env=self.env_id, discretizer="tiles", **tiles))
