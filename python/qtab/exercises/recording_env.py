"""The environment that a solution learns in: it records each step, and what the function has learned by then."""

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import counted
from qtab.envs.metadata.quantities import Quantities
from qtab.exercises.record import Event, Misuse, Record
from qtab.results.words import map_columns, state_in_words

RANDOM_NUMBERS = "random numbers"
"""The quantity that holds the state of the random generator."""


@dataclass(frozen=True)
class Transition:
    """A step, as a message describes it."""

    env: "RecordingEnv"
    observation: Any
    action: int
    reward: float
    next_observation: Any
    ending: str

    def __str__(self) -> str:
        action = self.env.action_name(self.action)
        before, after = self.env.in_words(self.observation), self.env.in_words(self.next_observation)
        return f"state {before}; action {action}; reward {self.reward:g}\nnext state {after}{self.ending}"


class RecordingEnv(gym.Wrapper[Any, Any, Any, Any]):
    """Records the tables, the random generator and the action at each step; the first reset has the seed.

    Args:
        env: The environment.
        known: The names of its states and actions.
        seed: The seed of the first reset.
        episodes: The number of episodes.
        tables: The arrays that the function changes, by their names.
        rng: The function's random generator; None if it has none.
        record: Receives the events.
    """

    def __init__(
        self,
        env: gym.Env,
        known: Quantities,
        seed: int,
        episodes: int,
        tables: Mapping[str, NDArray[np.float64]],
        rng: np.random.Generator | None,
        record: Record,
    ) -> None:
        super().__init__(env)
        self._known, self._seed, self._episodes = known, seed, episodes
        self._tables, self._rng, self._record = tables, rng, record
        self._columns = map_columns(env)
        self._episode = self._step = -1
        self._over = True
        self._has_reset_at_end = False
        self._observation: Any = None
        self._about: object = ""

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        """Starts an episode. One reset after the last episode is ignored, as long as no step follows.

        Raises:
            Misuse: for a seed, within the last episode, and for a second reset after it.
        """
        if seed is not None:
            raise Misuse("it calls env.reset with a seed: call env.reset() without one, the environment has its seed")
        if self._episode + 1 == self._episodes and self._over and not self._has_reset_at_end:
            self._has_reset_at_end = True  # finish records the tables
            return self.env.reset(options=options)
        if self._episode >= 0:
            self._see()
        if self._episode + 1 == self._episodes:
            raise self._one_episode_more()
        self._episode, self._step, self._over, self._about = self._episode + 1, -1, False, ""
        first_seed = self._seed if self._episode == 0 else None
        self._observation, info = self.env.reset(seed=first_seed, options=options)
        return self._observation, info

    def step(self, action: Any) -> Any:
        """Takes a step.

        Raises:
            Misuse: for an action that the environment does not have, and after the end of the episode or the last one.
        """
        if self._has_reset_at_end:
            raise self._one_episode_more()
        if self._over:
            when = "before env.reset()" if self._episode < 0 else "after the end of the episode"
            raise Misuse(
                f"{self._place}: it calls env.step {when}; an episode ends when terminated or truncated is true"
            )
        count = int(getattr(self.env.action_space, "n", 0))
        if not isinstance(action, int | np.integer) or isinstance(action, bool) or not 0 <= action < count:
            raise Misuse(f"{self._place}: an action must be an integer from 0 to {count - 1}, got {action!r}")
        self._see()
        self._step += 1
        self._record.events.append(
            Event(self._place, "action", int(action), f"state {self.in_words(self._observation)}", *self._where)
        )
        observation, reward, terminated, truncated, info = self.env.step(int(action))
        self._over = bool(terminated or truncated)
        ending = ", terminated" if terminated else ", truncated" if truncated else ""
        self._about = Transition(self, self._observation, int(action), float(reward), observation, ending)
        self._observation = observation
        return observation, reward, terminated, truncated, info

    def _one_episode_more(self) -> Misuse:
        return Misuse(f"it starts episode {self._episodes} (counted from 0), but episodes is {self._episodes}")

    def finish(self) -> None:
        """Records the tables after the last step.

        Raises:
            Misuse: if no episode was started, as by the starter code, or fewer than there should be.
        """
        if self._episode < 0:
            raise Misuse("it never calls env.reset(), which starts an episode")
        self._see()
        if self._episode + 1 < self._episodes:
            raise Misuse(f"it returns after {counted(self._episode + 1, 'episode')}, but episodes is {self._episodes}")

    def in_words(self, observation: Any) -> str:
        """Returns an observation in words, after its number if it is an integer."""
        words = state_in_words(self._known, observation, self._columns)
        return f"{int(observation)} ({words})" if self._columns is not None else words

    def action_name(self, action: int) -> str:
        """Returns the number and the name of an action."""
        names = self._known.actions
        return f"{action} ({names[action]})" if action < len(names) else str(action)

    @property
    def _where(self) -> tuple[int, int]:
        return max(self._episode, 0), self._step

    @property
    def _place(self) -> str:
        episode, step = self._where
        return f"episode {episode}, " + (f"step {step}" if step >= 0 else "before its first step")

    def _see(self) -> None:
        """Records the tables and the generator after the last step."""
        place = self._place
        for name, table in self._tables.items():
            self._record.events.append(Event(place, name, table.copy(), self._about, *self._where))
        if self._rng is not None:
            state = deepcopy(self._rng.bit_generator.state)
            self._record.events.append(Event(place, RANDOM_NUMBERS, state, self._about, *self._where))
