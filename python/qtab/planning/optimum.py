"""``qtab.Optimum``: what the best policy is worth."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Protocol, overload

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab.envs.registry import gymnasium_id, spec_of
from qtab.planning.gap import Gap
from qtab.planning.mountain_car import Search
from qtab.results.run import Run
from qtab.results.runs import Runs
from qtab.results.summary import FINAL_EPISODES


class Truth(Protocol):
    """How an optimum acts, and how it judges others."""

    remembers: bool
    """Whether the best action depends on the steps taken before."""

    def action(self, observation: ArrayLike, taken: int) -> int:
        """Returns the best action after so many steps of the episode."""

    def greedy_return(self, run: Run) -> tuple[float, float]:
        """Returns the return of a run's greedy policy, and its standard error."""


@dataclass(frozen=True, eq=False)
class Optimum:
    """The best policy of an environment, exactly, or the best that is known."""

    env: str
    """The environment's id, or the name of its class."""
    env_kwargs: Mapping[str, Any]
    max_episode_steps: int
    """The time limit that ``expected_return`` is under; in an environment without one that of training, 10,000."""
    method: str
    """``"finite_horizon"``, ``"value_iteration"``, ``"policy_iteration"`` or ``"search"``."""
    exact: bool
    """True where it is computed from a table, to the rounding of float64; False where it is achieved, not proved."""
    discount: float
    """Of ``values``, ``q_values`` and the policy; 1 is without."""
    values: NDArray[np.float64]
    """(*cells,): the discounted return to come, in the shape of a run's Q table; for ``"search"`` on a grid of
    positions and velocities. Where an observation hides something, such as whether a fickle passenger has made up
    their mind, it is what is true at first."""
    q_values: NDArray[np.float64]
    """(*cells, actions): the same for each action."""
    policy: NDArray[np.int64]
    """(*cells,): the best action, under a finite horizon that of an episode's beginning."""
    expected_return: float
    """Of the policy from the environment's first states, under the time limit, without a discount: what a run's
    returns are to be compared with."""
    reward_threshold: float | None
    """The return from which Gymnasium calls the environment solved, where it says so."""
    seconds: float
    """How long it took, by the wall clock."""
    search: Search | None = field(repr=False)
    """What was searched and found; None for a table."""
    truth: Truth = field(repr=False)
    """How it acts and judges."""

    @property
    def label(self) -> str:
        """What to write beside the number: the optimum, or the best that is known."""
        return "optimum" if self.exact else "best known"

    def predict(
        self,
        observation: ArrayLike,
        state: int | None = None,
        episode_start: Any = None,
        deterministic: bool = True,  # noqa: ARG002 - Stable-Baselines3's signature
    ) -> tuple[int, int | None]:
        """Returns the best action of an observation, and the state to hand in with the next one.

        Under a finite horizon what is best depends on the steps that are left: the state is how many were taken in
        the episode. Elsewhere it is None.

        Raises:
            ValueError: for an observation outside the space, or one that hides what the best action depends on.
        """
        if not self.truth.remembers:
            return self.truth.action(observation, 0), None
        started = state is None or bool(np.any(episode_start))
        taken = 0 if started else checks.integer("state", state, least=0)
        return self.truth.action(observation, taken), taken + 1

    @overload
    def gap(self, run: Run) -> Gap[float]: ...
    @overload
    def gap(self, run: Runs) -> Gap[NDArray[np.float64]]: ...
    def gap(self, run: Run | Runs) -> Gap[float] | Gap[NDArray[np.float64]]:
        """Returns how far a run is from the optimum, or each of many.

        The return of a greedy policy is exact where there is a table, and the mean of 1,000 episodes elsewhere.

        Raises:
            TypeError: for what is no run.
            ValueError: if the run is of another environment, or under another time limit.
        """
        if not isinstance(run, Run | Runs):
            raise TypeError(f"run must be a Run or Runs, got {run!r}")
        self._check(run)
        if isinstance(run, Run):
            last = run.episode_returns[-FINAL_EPISODES:]
            final = float(last.mean()) if len(last) else float("nan")
            return Gap(self.expected_return, final, *self.truth.greedy_return(run), label=self.label)
        judged = [(float("nan"),) * 2] * len(run) if run.tables is None else map(self.truth.greedy_return, run)
        greedy, error = np.array(list(judged), dtype=np.float64).reshape(len(run), 2).T
        return Gap(self.expected_return, run.final_returns(FINAL_EPISODES), greedy, error, label=self.label)

    def _check(self, run: Run | Runs) -> None:
        config = run.config
        ours = gymnasium_id(self.env), _whole(self.env, self.env_kwargs), self.max_episode_steps
        theirs = gymnasium_id(config.env), _whole(config.env, config.env_kwargs), config.max_episode_steps
        for name, our, their in zip(("env", "env_kwargs", "max_episode_steps"), ours, theirs, strict=True):
            if repr(our) != repr(their):
                raise ValueError(f"run must have {name} {our!r} as this optimum has, got {their!r}")

    def __str__(self) -> str:
        kind = "exact" if self.exact else "achieved, not proved to be the best"
        lines = {
            "expected return": f"{self.expected_return:.6g} within {self.max_episode_steps:,} steps",
            "threshold": "none" if self.reward_threshold is None else f"{self.reward_threshold:g}",
            "method": f"{self.method}, discount {self.discount:g}: {kind}",
            "states": " x ".join(map(str, self.values.shape)) + f", {self.q_values.shape[-1]} actions",
        }
        if self.search is not None:
            found = self.search.steps
            lines["routes"] = f"{found.min()} to {found.max()} steps from {len(found):,} starts"
            lines["predict"] = f"returns {self.search.followed_return:.6g} from them"
        lines["time"] = f"{self.seconds:.3g} s"
        return "\n".join([self.env, *(f"  {name:17}{text}" for name, text in lines.items())])


def _whole(env: str, kwargs: Mapping[str, Any]) -> dict[str, Any]:
    """The keyword arguments in one order, those of the id's spec included."""
    with suppress(gym.error.Error):  # the class of an environment that has no id
        kwargs = {**spec_of(env).kwargs, **kwargs}
    return {name: kwargs[name] for name in sorted(kwargs) if kwargs[name] is not None or name != "render_mode"}
