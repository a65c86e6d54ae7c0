"""``qtab.Optimum``: the best policy of an environment and its values."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, overload

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks, html
from qtab._utils.fields import with_fields
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.config.origin import Origin, copied, trained_on
from qtab.envs.origin.description import EnvironmentDescription, differences
from qtab.envs.registry import bare_id, spec_of
from qtab.planning.classic_control import GridSolver
from qtab.planning.gap import Gap
from qtab.planning.search import Search
from qtab.planning.tabular import StationaryPolicy, TabularSolver
from qtab.planning.tabulated_runs import AnyRun
from qtab.results.run import Run
from qtab.results.runs import Runs
from qtab.results.summary import FINAL_EPISODES


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class Optimum:
    """The best policy of an environment: exact from a transition table, or the best known."""

    env: str
    """The environment's id, or the name of its class."""
    env_kwargs: Mapping[str, Any]
    """Keyword arguments of the environment's constructor."""
    max_episode_steps: int
    """The time limit that ``expected_return`` assumes; 10,000, as in training, if the environment has none."""
    method: str
    """``"finite_horizon"``, ``"value_iteration"``, ``"policy_iteration"`` or ``"search"``."""
    exact: bool
    """True if computed from a transition table, up to float64 rounding; False if found by search and not proven."""
    discount: float
    """The discount of ``values``, ``q_values`` and ``policy``; 1 means no discount."""
    values: NDArray[np.float64]
    """(*cells,): the optimal state values, in the shape of a run's Q table without its last axis; for ``"search"`` on
    the grid of ``search.axes``, and for CartPole with a discount of 0.99. If an observation hides part of the state,
    such as whether Taxi's fickle passenger will change the destination, the values are those at the start of an
    episode."""
    q_values: NDArray[np.float64]
    """(*cells, actions): the optimal action values."""
    policy: NDArray[np.int64]
    """(*cells,): the best action; for ``"finite_horizon"`` at the start of an episode. For Pendulum, the index of one
    of 21 torques, equally spaced from the lowest to the highest."""
    expected_return: float
    """The undiscounted expected return of the policy from the environment's initial states under the time limit.
    Compare a run's returns with this number."""
    reward_threshold: float | None
    """The return at which Gymnasium considers the environment solved; None if it defines none, or only for another time
    limit or other keyword arguments."""
    seconds: float
    """The wall-clock time of the computation."""
    search: Search | None = field(repr=False)
    """The episodes that the search found; None for a transition table."""
    solver: TabularSolver | GridSolver = field(repr=False)
    """The solution behind :meth:`predict` and :meth:`gap`."""
    environment: EnvironmentDescription | None = field(default=None, repr=False)
    """The environment in detail, with the changes made to it after its construction."""

    @property
    def config(self) -> Config:
        """The environment and the time limit as a config, from which the environment can be made again."""
        config = Config(env=self.env, env_kwargs=self.env_kwargs, max_episode_steps=self.max_episode_steps)
        return copied(config, Origin(self.environment))

    @property
    def label(self) -> str:
        """``"optimum"``, or ``"best known"`` if it is not exact."""
        return "optimum" if self.exact else "best known"

    @property
    def stationary(self) -> StationaryPolicy | None:
        """The best policy known that ignores the number of steps taken, as runs without ``time_aware`` do.

        The criterion is the undiscounted return under the time limit. The search runs when the policy is first read.
        None for an optimum that was itself found by search, and for tables too large to search within seconds.
        """
        return self.solver.stationary if isinstance(self.solver, TabularSolver) else None

    def predict(
        self,
        observation: ArrayLike,
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = True,  # noqa: ARG002 - Stable-Baselines3's signature
    ) -> tuple[Any, Any]:
        """Returns the best action for an observation, and the state to pass with the next one.

        Under a finite horizon the best action depends on the steps left. The state is then the number of steps taken in
        the episode; otherwise it is None.

        For n observations, batched as in Gymnasium's vector environments, it returns an array of n actions and one of n
        states. The actions are (n,) int64, or for Pendulum (n, 1) float32.

        Args:
            observation: An observation, or n of them.
            state: The state that the last call returned; None for the start of an episode.
            episode_start: Whether an episode starts, with n observations (n,) booleans. None means no.
            deterministic: Ignored: the best policy is deterministic.

        Raises:
            TypeError: if ``state`` is not an integer, with n observations (n,) integers.
            ValueError: for an observation outside the space, or one that does not determine the best action; or for a
                ``state`` or ``episode_start`` of another length.
        """
        observation = self.solver.in_rows(observation)
        if np.ndim(observation) == len(self.solver.observation_shape) + 1:
            return self._predict_each(np.asarray(observation), state, episode_start)
        if not self.solver.needs_step_count:
            return self.solver.action(observation, 0), None
        is_first = state is None or bool(np.any(episode_start))
        steps_taken = 0 if is_first else checks.integer("state", state, least=0)
        return self.solver.action(observation, steps_taken), steps_taken + 1

    def _predict_each(self, observations: NDArray[Any], state: Any, episode_start: Any) -> tuple[Any, Any]:
        count = len(observations)
        states = _each("state", state, count)
        starts = _each("episode_start", episode_start, count)
        answers = [self.predict(*arguments) for arguments in zip(observations, states, starts, strict=True)]
        chosen = [action for action, _ in answers]
        continuous = self.solver.has_continuous_actions
        actions = np.array(chosen, np.float32).reshape(count, 1) if continuous else np.array(chosen, np.int64)
        if not self.solver.needs_step_count:
            return actions, None
        return actions, np.array([steps for _, steps in answers], dtype=np.int64)

    @overload
    def gap(self, run: Run) -> Gap[float]: ...
    @overload
    def gap(self, run: Runs) -> Gap[NDArray[np.float64]]: ...
    def gap(self, run: Run | Runs) -> Gap[float] | Gap[NDArray[np.float64]]:
        """Returns the shortfall of a run, or of each of several runs, from the optimum, and the part due to its table.

        The optimum of a table that :func:`qtab.tabulate` made is also compared with runs on the environment itself.
        Their greedy policy acts in each state by its observation.

        A table may be unable to represent the best policy: its cells join states that need different actions, or it
        does not include the number of steps taken. The best policy with that table is estimated: for cells, by dynamic
        programming that treats all states of a cell as one; for a transition table, by :attr:`stationary`. For tile
        coding, and for more than 60,000 cells, it is not known.

        The return of a greedy policy is exact with a transition table, otherwise the mean of 1,000 episodes.

        Raises:
            TypeError: if ``run`` is neither a Run nor Runs.
            ValueError: if the environment, its keyword arguments or the time limit of the run differ from this one's.
        """
        if not isinstance(run, Run | Runs):
            raise TypeError(f"run must be a Run or Runs, got {shown(run)}")
        run = as_solved(self, run)
        self.check_same_env(run)
        if isinstance(run, Run):
            last = run.episode_returns[-FINAL_EPISODES:]
            final_return = float(last.mean()) if len(last) else float("nan")
            greedy_return, error = self.solver.greedy_return(run)
            attainable = self._attainable_return(run, greedy_return)
            return Gap(self.expected_return, final_return, greedy_return, error, self.label, attainable)
        evaluated = [(float("nan"),) * 2] * len(run) if run.tables is None else map(self.solver.greedy_return, run)
        greedy, errors = np.array(list(evaluated), dtype=np.float64).reshape(len(run), 2).T
        attainable = None if run.tables is None or not len(run) else self._attainable_return(run[0], greedy)
        return Gap(self.expected_return, run.final_returns(), greedy, errors, self.label, attainable)

    def _attainable_return(self, run: Run, greedy_returns: ArrayLike) -> float | None:
        """Returns the return of the best policy known with the table of a run, at least that of its greedy policies."""
        found = self.solver.attainable_return(run)
        return None if found is None else max(found, float(np.max(greedy_returns)))

    def check_same_env(self, run: Run | Runs, *, with_limit: bool = True) -> None:
        """Checks that the environment of a run is that of this optimum.

        Args:
            run: The run, or many runs of one config.
            with_limit: Whether the time limits must be equal as well.

        Raises:
            ValueError: if the environment, its keyword arguments or the time limit of the run differ.
        """
        run = as_solved(self, run)
        config = run.config
        expected = bare_id(self.env), _all_kwargs(self.env, self.env_kwargs), self.max_episode_steps
        actual = bare_id(config.env), _all_kwargs(config.env, config.env_kwargs), config.max_episode_steps
        for name, ours, theirs in zip(("env", "env_kwargs", "max_episode_steps"), expected, actual, strict=True):
            if repr(ours) != repr(theirs) and (with_limit or name != "max_episode_steps"):
                raise ValueError(f"run must have {name} {ours!r} as this optimum has, got {theirs!r}")
        description = trained_on(config)
        if description is not None and self.environment is not None:
            found = differences(self.environment, description)
            if found:
                raise ValueError(f"run must be on the environment of this optimum, got another one: {'; '.join(found)}")

    def _facts(self, times: str) -> dict[str, str]:
        """The rows to print or to show in notebooks, without the time."""
        facts = {
            "expected return": f"{self.expected_return:.6g} within {self.max_episode_steps:,} steps",
            "certainty": "exact" if self.exact else "the best known policy, not proven optimal",
            "threshold": "none" if self.reward_threshold is None else f"{self.reward_threshold:g}",
            "method": f"{self.method}, discount {self.discount:g}",
            "states": times.join(map(str, self.values.shape)) + f", {self.q_values.shape[-1]} actions",
        }
        if self.search is not None:
            lengths = self.search.steps
            facts["episodes"] = f"{lengths.min()} to {lengths.max()} steps from {len(lengths):,} starts"
            facts["predict"] = f"mean return {self.search.predict_return:.6g} from the same starts"
        if self.stationary is not None:
            facts["stationary"] = (
                f"{self.stationary.expected_return:.6g} by the {self.stationary.label} policy that ignores the time"
            )
        return {**facts, "time": f"{self.seconds:.3g} s"}

    def __str__(self) -> str:
        lines = self._facts(" x ")
        lines["method"] += f": {lines.pop('certainty')}"
        return "\n".join([self.env, *(f"  {name:17}{text}" for name, text in lines.items())])

    def __repr__(self) -> str:
        """A one-line summary without the values."""
        return (
            f"<Optimum of {self.env}: {self.label} expected return {self.expected_return:.6g} "
            f"within {self.max_episode_steps:,} steps, by {self.method}>"
        )

    def _repr_html_(self) -> str:
        """A table and the state values, for notebooks."""
        facts: dict[str, object] = {**self._facts(" × ")}
        return html.summary(f"Optimum of {self.env}", facts, html.state_values("State values", self.values))


def _each(name: str, values: Any, count: int) -> list[Any]:
    """Returns one value for each of several observations."""
    if values is None:
        return [None] * count
    if np.shape(values) != (count,):
        raise ValueError(f"{name} must hold a value for each of the {count} observations, got {values!r}")
    return list(values)


def _all_kwargs(env: str, kwargs: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the keyword arguments, including those of the id's spec, sorted by name."""
    with suppress(gym.error.Error):  # the class of an environment that has no id
        kwargs = {**spec_of(env).kwargs, **kwargs}
    return {name: kwargs[name] for name in sorted(kwargs) if kwargs[name] is not None or name != "render_mode"}


def as_solved(optimum: Optimum, run: AnyRun) -> AnyRun:
    """Returns a run, or runs, on the environment that was tabulated, as on the solved table; any other run unchanged.

    Raises:
        ValueError: if that environment has the same name as the run's, but differs from it.
    """
    return optimum.solver.as_solved(run) if isinstance(optimum.solver, TabularSolver) else run
