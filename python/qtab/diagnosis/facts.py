"""What the checks look at: a run, its repetition, and its environment. Each fact is computed when it is first used."""

from dataclasses import dataclass
from functools import cached_property

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.memory import memory_limit
from qtab.config import Config
from qtab.config.options import AVERAGE_REWARD, MONTE_CARLO, PREFERENCES
from qtab.diagnosis.sample import Sample, sample_steps
from qtab.envs.goals import BEST_KNOWN_MOUNTAIN_CAR, MAX_QUICK_UPDATES, is_usual_mountain_car, reward_threshold
from qtab.envs.registry import entry_for_id
from qtab.envs.stored import spec_of_run
from qtab.planning.optimum import Optimum
from qtab.planning.solve import optimum as solve
from qtab.reference.streams import agent_stream
from qtab.results.run import Run
from qtab.results.summary import FINAL_EPISODES
from qtab.results.time_steps import at_step
from qtab.training.evaluate import Evaluation, evaluate
from qtab.training.extensions import repeatable
from qtab.training.train import train
from qtab.training.train_many import seed_sequence, train_many

EVALUATION_EPISODES = 100
RANDOM_EPISODES = 500
SHORTEST_MOUNTAIN_CAR, LONGEST_MOUNTAIN_CAR = 83, 104
"""The lengths of its routes: from the best and from the worst start."""
OTHER_SEEDS_STEPS = 10**7
"""How many steps, times the number of active rows, training with other seeds may take."""
FEWEST_SEEDS, MOST_SEEDS = 8, 40


@dataclass(frozen=True)
class Facts:
    """A run and what follows from it."""

    run: Run
    given_optimum: Optimum | None = None
    given_seeds: int | None = None

    @property
    def config(self) -> Config:
        """The config of the run."""
        return self.run.config

    @cached_property
    def can_repeat(self) -> bool:
        """Whether the whole run can be repeated quickly: Rust steps its environment, which can be made from its id."""
        try:
            spec_of_run(self.config.env)
        except (gym.error.UnregisteredEnv, ModuleNotFoundError):
            return False
        finished = len(self.run.episode_returns)
        return self.config.backend == "rust" and repeatable(self.run)[1] == finished > 0

    @cached_property
    def is_finite(self) -> bool:
        """Whether all values of the tables are finite; those of missing actions are -inf from the start."""
        return bool((np.isfinite(self.run.tables) | np.isneginf(self.initial_tables)).all())

    @cached_property
    def final_return(self) -> float:
        """The mean return of the last 100 training episodes."""
        last = self.run.episode_returns[-FINAL_EPISODES:]
        return float(last.mean()) if len(last) else float("nan")

    @cached_property
    def greedy(self) -> Evaluation | None:
        """Episodes of the greedy policy; None where they cannot be played quickly."""
        if not (self.can_repeat and self.is_finite):
            return None
        return evaluate(self.run, EVALUATION_EPISODES, seed=0, progress=False)

    @cached_property
    def random(self) -> Run | None:
        """Episodes of a policy that chooses all actions at random; None where they cannot be played quickly."""
        if not self.can_repeat:
            return None
        # These algorithms do not take all of the settings below; what chooses at random does not depend on its values.
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
    def threshold(self) -> float | None:
        """The return at which Gymnasium considers the environment solved; None where it gives none."""
        return reward_threshold(self.config.env)

    @cached_property
    def optimum(self) -> Optimum | None:
        """The optimum that was given, or that of a small table."""
        if self.given_optimum is not None:
            return self.given_optimum
        entry = entry_for_id(self.config.env)
        updates = at_step(self.run).discretizer.n_rows * len(self.run.actions) * (self.config.max_episode_steps or 0)
        if not self.can_repeat or entry is None or not entry.knows_transitions or updates > MAX_QUICK_UPDATES:
            return None
        return solve(self.run)

    @cached_property
    def is_usual_mountain_car(self) -> bool:
        """Whether the run is on MountainCar-v0 with its own constants and time limit."""
        return is_usual_mountain_car(self.config)

    @cached_property
    def best_return(self) -> float | None:
        """The expected return of the optimum, or the best known; None where neither is known."""
        if self.optimum is not None:
            return self.optimum.expected_return
        return BEST_KNOWN_MOUNTAIN_CAR if self.is_usual_mountain_car else None

    @cached_property
    def goal_return(self) -> float | None:
        """The return from which on the run counts as solved: the threshold, or nearly the optimum if that is lower."""
        if self.best_return is None:
            return self.threshold
        nearly = self.best_return - max(0.02 * abs(self.best_return), 0.01)
        return nearly if self.threshold is None else min(self.threshold, nearly)

    @cached_property
    def solved(self) -> bool | None:
        """Whether the greedy policy, or the last episodes of training, reach the goal; None where none is known."""
        if self.goal_return is None or not self.is_finite:
            return None if self.is_finite else False
        if self.greedy_is_exact:
            return self.greedy_return >= self.goal_return
        if self.final_return >= self.goal_return:
            return True
        return self.greedy is not None and self.greedy_return >= self.goal_return

    @cached_property
    def greedy_is_exact(self) -> bool:
        """Whether the return of a greedy policy is computed exactly, from a transition table.

        What counts of preferences is the policy that was trained, their softmax, not the greedy one.
        """
        is_softmax = self.config.algorithm in PREFERENCES
        return self.optimum is not None and self.optimum.exact and self.is_finite and not is_softmax

    @cached_property
    def greedy_return(self) -> float:
        """The return of the greedy policy: exact with a transition table; NaN where it is not known."""
        if self.optimum is not None and self.greedy_is_exact:
            return float(self.optimum.gap(self.run).greedy_return)
        return float("nan") if self.greedy is None else self.greedy.mean_return

    @cached_property
    def failure_return(self) -> float | None:
        """The return of most episodes of a random policy, where most have the same: those that reach no goal."""
        if self.random is None:
            return None
        returns, counts = np.unique(self.random.episode_returns, return_counts=True)
        most = int(np.argmax(counts))
        return float(returns[most]) if counts[most] > RANDOM_EPISODES / 2 and most == 0 else None

    @cached_property
    def reached(self) -> NDArray[np.bool_] | None:
        """(episodes,): whether each episode did better than most of a random policy; None where returns are mixed."""
        return None if self.failure_return is None else self.run.episode_returns > self.failure_return

    @cached_property
    def shortest_route(self) -> int | None:
        """The fewest steps to the goal that are known; None where none is, or an episode is better the longer it is."""
        if self.is_usual_mountain_car:
            return SHORTEST_MOUNTAIN_CAR
        run = self.run
        if self.reached is None or not (run.terminated & self.reached).any():
            return None
        return int(run.episode_lengths[run.terminated & self.reached].min())

    @cached_property
    def initial_tables(self) -> NDArray[np.float64]:
        """(k, rows, actions): the tables before the first episode."""
        initial, shape = self.config.initial_q, self.run.tables.shape
        if isinstance(initial, tuple):
            stream = agent_stream(self.config.seed or 0, self.config.bit_generator)
            return np.stack([stream.uniform(*initial, size=shape[1:]) for _ in range(shape[0])])
        return np.broadcast_to(np.asarray(initial, dtype=np.float64).reshape(-1), (int(np.prod(shape)),)).reshape(shape)

    @cached_property
    def changed(self) -> NDArray[np.bool_]:
        """(rows, actions): whether a value has changed since the start, in either table."""
        return np.asarray(np.any(self.run.tables != self.initial_tables, axis=0))

    @cached_property
    def tried(self) -> NDArray[np.bool_]:
        """(rows, actions): whether the action was taken there: by the run's visits, or else whether its value changed.

        Without visits, an update that leaves the value as it was goes unnoticed, such as one of 0 towards 0.
        """
        visits = self.run.visits
        return self.changed if visits is None else np.asarray(visits.reshape(self.changed.shape) > 0)

    @cached_property
    def visited(self) -> NDArray[np.bool_]:
        """(rows,): whether any action was taken there."""
        return np.asarray(np.any(self.tried, axis=1))

    @cached_property
    def q_values(self) -> NDArray[np.float64]:
        """(rows, actions): the values; the mean of two tables."""
        mean: NDArray[np.float64] = self.run.tables.mean(axis=0)
        return np.where(self.has_action, mean, -np.inf)

    @cached_property
    def has_action(self) -> NDArray[np.bool_]:
        """(rows, actions): which actions each state has."""
        not_missing: NDArray[np.bool_] = np.asarray(np.isfinite(self.initial_tables).all(axis=0))
        masks = self.run.action_masks
        return not_missing if masks is None else not_missing & masks.reshape(not_missing.shape)

    @cached_property
    def sample(self) -> Sample | None:
        """The steps of the last episodes; None where they cannot be repeated quickly."""
        return sample_steps(self.run) if self.can_repeat and self.is_finite else None

    @cached_property
    def other_returns(self) -> NDArray[np.float64] | None:
        """(seeds,): the returns of the same config with other seeds; None where they would take too long.

        They are those of the greedy policies where these are exact, else of the last 100 episodes.
        """
        count = self._other_seeds()
        if not self.can_repeat or count == 0 or not self.run.completed:
            return None
        numbers = seed_sequence(count + 1, memory_limit(None))  # refuses too many before there is a list of them
        seeds = [seed for seed in numbers if seed != self.config.seed][:count]
        runs = train_many(config=self.config, seeds=seeds, tables=self.greedy_is_exact)
        if self.optimum is not None and self.greedy_is_exact:
            return self.optimum.gap(runs).greedy_return
        return runs.final_returns()

    def _other_seeds(self) -> int:
        if self.given_seeds is not None:
            return self.given_seeds
        work = int(self.run.episode_lengths.sum()) * self.run.discretizer.n_active
        affordable = min(OTHER_SEEDS_STEPS // max(work, 1), MOST_SEEDS)
        # Fewer seeds than this say little: they may take up to twice as long.
        return max(affordable, FEWEST_SEEDS) if 2 * affordable >= FEWEST_SEEDS else 0
