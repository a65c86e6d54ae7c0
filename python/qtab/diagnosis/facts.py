"""The facts that the checks read: a run, its repetition, and its environment. Each is computed on first use."""

from dataclasses import dataclass
from functools import cached_property

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.choices import IN_PYTHON
from qtab.config.options import AVERAGE_REWARD, MONTE_CARLO, PREFERENCES
from qtab.diagnosis.greedy import GreedyEpisodes, play_greedily
from qtab.diagnosis.sample import Sample, repeat, sample_steps, shortest_best_episode
from qtab.envs.metadata.goals import BEST_KNOWN_MOUNTAIN_CAR, is_usual_mountain_car
from qtab.envs.registry import bare_id
from qtab.planning.optimum import Optimum
from qtab.planning.solve import quick_optimum
from qtab.results.action_values import are_finite, initial_tables
from qtab.results.rates import repeatable
from qtab.results.run import Run
from qtab.results.runs import Runs
from qtab.training.setup.run_env import can_be_made
from qtab.training.train import train
from qtab.training.train_many import seed_sequence, train_many
from qtab.training.verdict import Verdict, judge

RANDOM_EPISODES = 500
SHORTEST_MOUNTAIN_CAR, LONGEST_MOUNTAIN_CAR = 83, 104
"""The numbers of steps of the shortest routes in MountainCar-v0, from the best and from the worst start."""
OTHER_SEEDS_STEPS = 10**7
"""The largest number of steps, times the number of active rows, to train with other seeds."""
FEWEST_SEEDS, MOST_SEEDS = 8, 40


@dataclass(frozen=True)
class Facts:
    """A run and the facts computed from it."""

    run: Run
    given_optimum: Optimum | None = None
    given_seeds: int | None = None
    given_env: gym.Env | None = None

    @property
    def config(self) -> Config:
        """The config of the run."""
        return self.run.config

    @property
    def can_repeat(self) -> bool:
        """Whether the whole run can be repeated quickly: Rust steps its environment, which can be made again."""
        return not self.why_not_repeated

    @cached_property
    def why_not_repeated(self) -> str:
        """The reason why the run cannot be repeated quickly, to follow the word "as"; empty if it can."""
        if self.config.backend in IN_PYTHON:
            return "Rust cannot repeat this run"
        if not can_be_made(self.config):
            return "its environment cannot be made again"
        if repeatable(self.run)[1] < len(self.run.episode_returns):
            return "it was resumed with more episodes while a rate fell, and cannot be repeated"
        return ""

    @cached_property
    def is_finite(self) -> bool:
        """Whether all values of the tables are finite."""
        return are_finite(self.run)

    @cached_property
    def verdict(self) -> Verdict:
        """Whether the run solved its environment, with the measured returns."""
        return judge(self.run, self.optimum)

    @property
    def greedy(self) -> GreedyEpisodes | None:
        """Episodes of the greedy policy; None if they cannot be played, for the reason in ``why_not_played``."""
        return self._greedy if isinstance(self._greedy, GreedyEpisodes) else None

    @property
    def why_not_played(self) -> str:
        """The reason why the greedy policy was not played, to follow the word "as"; empty if it was."""
        return "" if isinstance(self._greedy, GreedyEpisodes) else self._greedy

    @cached_property
    def _greedy(self) -> GreedyEpisodes | str:
        if not self.is_finite:
            return "the values diverged"
        if self.given_env is None and not can_be_made(self.config):
            return "its environment cannot be made again without env="
        return play_greedily(self.run, self.given_env) or "a greedy episode takes longer than the training"

    @property
    def solved(self) -> bool | None:
        """Whether the run solved its environment; None if it is not known."""
        return self.verdict.solved

    @property
    def goal_return(self) -> float | None:
        """The smallest return that counts as solved; None if it is not known."""
        return self.verdict.goal.least

    @cached_property
    def random(self) -> Run | None:
        """Episodes of a policy that acts at random; None if they cannot be played quickly."""
        if not self.can_repeat:
            return None
        # These algorithms do not accept all of the settings below; random actions do not depend on the algorithm.
        special = self.config.algorithm in (*PREFERENCES, *MONTE_CARLO, *AVERAGE_REWARD)
        return train(
            config=self.config,
            algorithm="q_learning" if special else self.config.algorithm,
            exploration="epsilon_greedy",
            epsilon=1.0,
            epsilon_schedule="constant",
            learning_rate=0.0,
            learning_rate_schedule="constant",
            terminal_update="target",
            episodes=RANDOM_EPISODES,
            seed=0,
            progress=False,
        )

    @cached_property
    def optimum(self) -> Optimum | None:
        """The given optimum, or the computed one of a small table."""
        if self.given_optimum is not None:
            return self.given_optimum
        return quick_optimum(self.config, self.run.discretizer.n_rows, len(self.run.actions))

    @cached_property
    def is_usual_mountain_car(self) -> bool:
        """Whether the run is on MountainCar-v0 with the default constants and time limit."""
        return is_usual_mountain_car(self.config)

    @cached_property
    def best_return(self) -> float | None:
        """The expected return of the optimum, or the best known return; None if neither is known."""
        if self.optimum is not None:
            return self.optimum.expected_return
        return BEST_KNOWN_MOUNTAIN_CAR if self.is_usual_mountain_car else None

    @cached_property
    def failure_return(self) -> float | None:
        """The lowest return of a random policy if most of its episodes have it: those that do not reach the goal."""
        if self.random is None:
            return None
        returns, counts = np.unique(self.random.episode_returns, return_counts=True)
        most = int(np.argmax(counts))
        return float(returns[most]) if counts[most] > RANDOM_EPISODES / 2 and most == 0 else None

    @cached_property
    def reached(self) -> NDArray[np.bool_] | None:
        """(episodes,): whether the return of each episode is above ``failure_return``; None if that is None."""
        return None if self.failure_return is None else self.run.episode_returns > self.failure_return

    @cached_property
    def shortest_route(self) -> int | None:
        """The smallest known number of steps to the goal; None if none is known, or if longer episodes are better."""
        if self.is_usual_mountain_car:
            return SHORTEST_MOUNTAIN_CAR
        run = self.run
        if self.reached is not None and (run.terminated & self.reached).any():
            return int(run.episode_lengths[run.terminated & self.reached].min())
        # The optimum of a table does not act by the observations of the environment that was tabulated.
        same = self.optimum is not None and bare_id(self.optimum.env) == bare_id(run.config.env)
        if self.optimum is not None and same and self.optimum.exact and self.can_repeat:
            return shortest_best_episode(self.config, self.optimum)
        return None

    @cached_property
    def initial_tables(self) -> NDArray[np.float64]:
        """(k, rows, actions): the tables before the first episode."""
        return initial_tables(self.run)

    @cached_property
    def changed(self) -> NDArray[np.bool_]:
        """(rows, actions): whether a value has changed since the start, in either table."""
        return np.asarray(np.any(self.run.tables != self.initial_tables, axis=0))

    @cached_property
    def tried(self) -> NDArray[np.bool_]:
        """(rows, actions): whether the action was taken in the state, by its visits, or else by a changed value.

        Without visits, an update that does not change the value goes unnoticed, such as one of 0 towards 0.
        """
        return self.changed if self.visits is None else self.visits > 0

    @cached_property
    def visits(self) -> NDArray[np.int64] | None:
        """(rows, actions): the number of times that the action was taken in the state; None if it is not known."""
        visits = self.run.visits
        if visits is None and self.repeated is not None:
            visits = self.repeated.visits
        return None if visits is None else visits.reshape(self.changed.shape)

    @cached_property
    def repeated(self) -> Run | None:
        """The run, repeated with its visits and the last episodes recorded; None if that would take long."""
        return repeat(self.run) if self.can_repeat and self.is_finite else None

    @cached_property
    def visited(self) -> NDArray[np.bool_]:
        """(rows,): whether any action was taken in the state."""
        return np.asarray(np.any(self.tried, axis=1))

    @cached_property
    def q_values(self) -> NDArray[np.float64]:
        """(rows, actions): the action values; for two tables their mean."""
        mean: NDArray[np.float64] = self.run.tables.mean(axis=0)
        return np.where(self.has_action, mean, -np.inf)

    @cached_property
    def has_action(self) -> NDArray[np.bool_]:
        """(rows, actions): whether each state has each action."""
        not_missing: NDArray[np.bool_] = np.asarray(np.isfinite(self.initial_tables).all(axis=0))
        masks = self.run.action_masks
        return not_missing if masks is None else not_missing & masks.reshape(not_missing.shape)

    @cached_property
    def sample(self) -> Sample | None:
        """The steps of the last episodes; None if they cannot be repeated quickly."""
        return None if self.repeated is None else sample_steps(self.repeated)

    @cached_property
    def others(self) -> Runs | None:
        """The runs of the same config with other seeds; None if they would take too long."""
        count = self._other_seeds()
        if not self.can_repeat or count == 0 or not self.run.completed:
            return None
        numbers = seed_sequence(count + 1)  # raises for too many before making a list of them
        seeds = [seed for seed in numbers if seed != self.config.seed][:count]
        return train_many(config=self.config, seeds=seeds, tables=True)

    def _other_seeds(self) -> int:
        if self.given_seeds is not None:
            return self.given_seeds
        work = int(self.run.episode_lengths.sum()) * self.run.discretizer.n_active
        affordable = min(OTHER_SEEDS_STEPS // max(work, 1), MOST_SEEDS)
        # Fewer seeds are of little use, so that FEWEST_SEEDS may take up to twice as long.
        return max(affordable, FEWEST_SEEDS) if 2 * affordable >= FEWEST_SEEDS else 0
