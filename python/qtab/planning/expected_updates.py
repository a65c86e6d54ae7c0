"""Planning by expected updates of single state-action pairs, and the distributions of these updates."""

from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from qtab import _core
from qtab._utils import checks
from qtab.planning.table import opened_table


class ExpectedUpdates:
    """Q(s, a) ← Σ p (r + γ max Q(s', ·)) for one state-action pair after another, from values of 0.

    Sutton & Barto, 2nd ed., section 8.6. The random numbers are those of ``np.random.default_rng(seed)``: for each
    simulated step those of the policy, then that of the transition; for each episode first that of its initial state.

    Args:
        env: A Gymnasium id, an ``EnvSpec`` or an environment with a transition table, which is neither stepped nor
            closed.
        distribution: The pairs to update: ``"uniform"`` updates all in turn, the actions of state 0 first;
            ``"on_policy"`` those that occur in simulated episodes under the ε-greedy policy, whose ties are broken at
            random.
        discount: The discount, in [0, 1].
        epsilon: ε of the ε-greedy policy, in [0, 1]; ignored with ``"uniform"``.
        seed: The seed of the simulated episodes.
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an environment without a transition table.
    """

    def __init__(
        self,
        env: str | EnvSpec | gym.Env,
        distribution: str = "uniform",
        discount: float = 1.0,
        *,
        epsilon: float = 0.1,
        seed: int = 0,
        env_kwargs: Mapping[str, Any] | None = None,
    ) -> None:
        checks.choice("distribution", distribution, ("uniform", "on_policy"))
        discount, epsilon = checks.real("discount", discount, 0.0, 1.0), checks.real("epsilon", epsilon, 0.0, 1.0)
        seed = checks.integer("seed", seed, least=0)
        with opened_table(env, env_kwargs) as table:
            self._shape = *table.cells.shape, len(table.actions)
            used = None if distribution == "uniform" else epsilon
            self._planning = _core.ExpectedUpdates(table.native, discount, used, seed)

    def advance(self, updates: int) -> None:
        """Makes more updates.

        Raises:
            OverflowError: if a value exceeds the range of float64; the earlier updates are kept.
            TypeError: if the number is not an integer.
            ValueError: if it is negative.
        """
        self._planning.advance(checks.count("updates", updates, least=0))

    @property
    def q_values(self) -> NDArray[np.float64]:
        """(*cells, actions): the action values."""
        values = self._planning.q_values()
        return values[: int(np.prod(self._shape))].reshape(self._shape)

    def greedy_return(self) -> float:
        """Returns the expected discounted return of the greedy policy. Ties go to the first action.

        The return is exact up to rounding errors.

        Raises:
            OverflowError: if it exceeds the range of float64.
            ValueError: if the policy collects rewards forever without a discount.
        """
        return self._planning.greedy_return()
