"""``qtab.planning.Transitions``: a batch of transitions, from arrays, a table, an environment, or a run."""

from collections.abc import Callable, Mapping
from contextlib import closing, nullcontext
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab._utils.arrays import numbers
from qtab._utils.shown import counted, shown
from qtab.envs.actions import Actions, choose_actions, flat
from qtab.planning.policies import RANDOM, answered, equal_probabilities
from qtab.planning.table import opened_env, opened_table
from qtab.results.run import Run
from qtab.results.run_state import restored_generator
from qtab.training.restore import continue_after
from qtab.training.setup.run_env import check_same, make_run_env


class Transitions:
    """Transitions from a state to the next, from any number of episodes and any policy, in any order.

    Args:
        observations: (n, *shape) numbers: the observation of each state.
        actions: (n,) integers: the action taken, counted from 0.
        rewards: (n,) numbers: the reward.
        next_observations: (n, *shape) numbers: the observation of each next state.
        terminated: (n,) booleans: whether the next state is terminal, so that its value is zero. The end of an episode
            by a time limit is not.
        n_actions: The number of actions; None means one more than the largest in ``actions``.
        weights: (n,) numbers: how often each transition counts, at least 0; None means that each counts once.

    Raises:
        TypeError: if an array does not hold such values.
        ValueError: for arrays of different lengths, or an action, a reward or a weight out of range.
    """

    observations: NDArray[Any]
    """(n, *shape): the observation of each state."""
    actions: NDArray[np.int64]
    """(n,): the action taken, counted from 0."""
    rewards: NDArray[np.float64]
    """(n,): the reward."""
    next_observations: NDArray[Any]
    """(n, *shape): the observation of each next state."""
    terminated: NDArray[np.bool_]
    """(n,): whether the next state is terminal."""
    n_actions: int
    """The number of actions."""
    weights: NDArray[np.float64]
    """(n,): how often each transition counts."""
    masked: bool
    """Whether they are recorded episodes of a run with action masks; :func:`qtab.planning.lspi` then needs these."""

    def __init__(
        self,
        observations: ArrayLike,
        actions: ArrayLike,
        rewards: ArrayLike,
        next_observations: ArrayLike,
        terminated: ArrayLike,
        n_actions: int | None = None,
        weights: ArrayLike | None = None,
    ) -> None:
        self.masked = False
        self.observations = observed("observations", observations)
        self.next_observations = observed("next_observations", next_observations)
        count, taken, ends = len(self.observations), np.asarray(actions), np.asarray(terminated)
        if taken.dtype.kind not in "iu":
            raise TypeError(f"actions must hold integers, got dtype {taken.dtype}")
        if ends.dtype != np.bool_:
            raise TypeError(f"terminated must hold booleans, got dtype {ends.dtype}")
        self.actions, self.terminated = taken.astype(np.int64), ends
        self.rewards = numbers("rewards", rewards)
        self.weights = np.ones(count) if weights is None else numbers("weights", weights)
        for name in ("actions", "rewards", "next_observations", "terminated", "weights"):
            found = getattr(self, name).shape
            expected = self.observations.shape if name == "next_observations" else (count,)
            if found != expected:
                raise ValueError(f"{name} must have the shape {expected}, as observations have, got {found}")
        if (self.weights < 0.0).any():
            raise ValueError(f"weights must be at least 0, got {self.weights.min():g}")
        least, largest = int(self.actions.min()), int(self.actions.max())
        self.n_actions = largest + 1 if n_actions is None else checks.integer("n_actions", n_actions, least=1)
        if least < 0 or largest >= self.n_actions:
            wrong = least if least < 0 else largest
            raise ValueError(f"actions must be numbers from 0 to {self.n_actions - 1}, got {wrong}")

    @classmethod
    def of_table(cls, env: str | EnvSpec | gym.Env, *, env_kwargs: Mapping[str, Any] | None = None) -> "Transitions":
        """Returns all transitions of a transition table, weighted by their probabilities.

        Each action in each state counts once, so that there is no chance in what is computed from them.

        Args:
            env: A Gymnasium id, an ``EnvSpec`` or an environment with a transition table, which is neither stepped nor
                closed. Observations show the whole state.
            env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.

        Raises:
            gymnasium.error.Error: from Gymnasium, for an unknown id.
            TypeError: for an argument of the wrong type.
            ValueError: for an environment without a transition table, or whose observations hide part of the state.
        """
        with opened_table(env, env_kwargs) as table:
            cells, solver, count = table.cells, table.solver, len(table.actions)
            if len(solver.rows) != cells.n_rows:
                raise ValueError(f"env must show its whole state, which the observations of {table.name} do not")
            listed = solver.transitions()
        rows = [
            (*divmod(pair, count), *transition)
            for pair, transitions in enumerate(listed)
            for transition in transitions
            if transition[0] > 0.0
        ]
        state, action, probability, next_state, reward, terminated = zip(*rows, strict=True)
        if cells.low.ndim:
            every = np.stack(np.unravel_index(np.arange(cells.n_rows), cells.shape), axis=-1) + cells.low
        else:
            every = np.arange(cells.n_rows) + cells.low
        return cls(
            every[list(state)],
            np.array(action),
            np.array(reward, np.float64),
            every[list(next_state)],
            np.array(terminated, np.bool_),
            count,
            np.array(probability),
        )

    @classmethod
    def sample(
        cls,
        env: str | EnvSpec | gym.Env,
        steps: int,
        policy: Callable[[Any], Any] | str = RANDOM,
        *,
        seed: int = 0,
        env_kwargs: Mapping[str, Any] | None = None,
    ) -> "Transitions":
        """Steps an environment and returns its transitions; an environment with a table draws them from ``P``.

        Args:
            env: A Gymnasium id, an ``EnvSpec`` or an environment with discrete actions. It is reset at first and
                whenever an episode ends, also by its time limit. One that was made here is closed afterwards.
            steps: The number of steps.
            policy: ``"random"`` for equal probabilities, or a function from an observation to the number of an action
                or to (actions,) probabilities. The environment's action masks are not read: the policy decides.
            seed: The seed of the environment, and of ``np.random.default_rng``, which draws the actions.
            env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.

        Raises:
            gymnasium.error.Error: from Gymnasium, for an unknown id.
            TypeError: for an argument of the wrong type, or observations that are not numbers.
            ValueError: for an argument out of range, or a space of actions that is not discrete.
        """
        steps, seed = checks.count("steps", steps, least=1), checks.integer("seed", seed, least=0)
        if not callable(policy):
            equal_probabilities("policy", policy, 1, 1)
        generator = np.random.default_rng(seed)
        collected = _Collected()
        with opened_env(env, env_kwargs) as (_, opened):
            space = opened.action_space
            if isinstance(space, gym.spaces.Box) and np.issubdtype(space.dtype, np.floating):
                raise ValueError(f"env must have discrete actions, got {space}")
            actions = choose_actions(space, None)
            observation, _ = opened.reset(seed=seed)
            for _ in range(steps):
                column = _column(policy, observation, actions, generator)
                following, reward, terminated, truncated, _ = opened.step(actions[column])
                collected.add(observation, column, reward, following, terminated)
                observation = opened.reset()[0] if terminated or truncated else following
        return collected.transitions(len(actions))

    @classmethod
    def recorded(cls, run: Run, env: gym.Env | None = None) -> "Transitions":
        """Returns the transitions of the recorded episodes of a run, which are replayed in its environment.

        Args:
            run: A run with recordings, as ``qtab.train(..., record=100)`` makes it.
            env: The environment of the run, if it cannot be made from an id. It is not closed.

        Raises:
            TypeError: if ``run`` is not a run, or observations are not numbers.
            ValueError: for a run without recordings, or another environment than the run's.
        """
        checks.instance("run", run, Run)
        if not run.recordings:
            raise ValueError("run must have recorded episodes, as qtab.train(..., record=100) keeps them")
        columns = {tuple(flat(run.actions[column])): column for column in range(len(run.actions))}
        collected = _Collected()
        if env is not None:
            check_same(run, env)
        with closing(make_run_env(run.config)) if env is None else nullcontext(env) as opened:
            # The first reset of a run can draw state for all episodes, such as a bandit problem.
            opened.unwrapped.reset(seed=run.config.seed)
            for recording in run.recordings:
                continue_after(opened, int(run.episode_lengths[: recording.episode].sum()))
                opened.unwrapped.np_random = restored_generator(recording.start)
                observation, _ = opened.reset()
                for action in recording.actions:
                    following, reward, terminated, _, _ = opened.step(action)
                    collected.add(observation, columns[tuple(flat(action))], reward, following, terminated)
                    observation = following
        found = collected.transitions(len(run.actions))
        found.masked = run.config.action_mask is not False
        return found

    def __len__(self) -> int:
        """Returns the number of transitions."""
        return len(self.actions)

    def __repr__(self) -> str:
        """A one-line summary without the arrays."""
        return f"<{counted(len(self), 'transition').capitalize()}, {counted(self.n_actions, 'action')}>"


class _Collected:
    """The transitions of episodes, one at a time."""

    def __init__(self) -> None:
        self._rows: list[tuple[Any, int, float, Any, bool]] = []

    def add(self, observation: Any, column: int, reward: Any, following: Any, terminated: Any) -> None:
        # Copied, because environments may change their observations in place.
        self._rows.append((np.array(observation), column, float(reward), np.array(following), bool(terminated)))

    def transitions(self, n_actions: int) -> Transitions:
        observations, actions, rewards, following, terminated = map(list, zip(*self._rows, strict=True))
        return Transitions(
            np.array(observations), np.array(actions), np.array(rewards), np.array(following), np.array(terminated),
            n_actions,
        )  # fmt: skip


def _column(
    policy: Callable[[Any], Any] | str, observation: Any, actions: Actions, generator: np.random.Generator
) -> int:
    """Returns the column of the action that a policy chooses."""
    if not callable(policy):
        return int(generator.integers(len(actions)))
    probabilities = answered("policy", policy(observation), observation, actions)
    if max(probabilities) == 1.0:
        return probabilities.index(1.0)
    return int(generator.choice(len(actions), p=probabilities))


def observed(name: str, values: ArrayLike) -> NDArray[Any]:
    """Returns observations as an array of numbers.

    Raises:
        TypeError: if they are not numbers in arrays of one shape.
        ValueError: if there are none.
    """
    try:
        array = np.asarray(values)
    except ValueError:  # of different lengths
        array = np.asarray(None)
    if array.dtype.kind not in "biuf":
        raise TypeError(f"{name} must be an array of numbers, got {shown(values)}")
    if array.ndim == 0 or not len(array):
        raise ValueError(f"{name} must hold at least 1 observation, got {shown(values)}")
    return array
