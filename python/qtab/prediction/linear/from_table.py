"""``qtab.prediction.linear_geometry``: the geometry of linear values from a transition table and a feature matrix."""

from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import ArrayLike

from qtab._utils import checks
from qtab._utils.arrays import numbers
from qtab._utils.memory import check_memory
from qtab.config.unknown import suggesting
from qtab.planning.least_squares.lstdq import GivenFeatures
from qtab.planning.policies import SUM_TOLERANCE, GivenPolicy, probabilities
from qtab.planning.policy_values import policy_values
from qtab.planning.table import opened_table
from qtab.prediction.features import feature_matrix, features_of_function
from qtab.prediction.linear.chain import MATRICES, FloatArray, chain_of
from qtab.prediction.linear.geometry import LinearGeometry


@suggesting
def linear_geometry(
    env: str | EnvSpec | gym.Env,
    policy: GivenPolicy,
    features: GivenFeatures | None = None,
    discount: float = 1.0,
    *,
    trace_decay: float = 0.0,
    behavior: GivenPolicy | None = None,
    distribution: ArrayLike | None = None,
    env_kwargs: Mapping[str, Any] | None = None,
) -> LinearGeometry:
    """Computes the fixed point of TD and the errors of linear values exactly, from a transition table.

    Sutton & Barto, 2nd ed., sections 9.4 and 11.4 to 11.6. The arrays grow with the squares of the numbers of states
    and features.

    Args:
        env: A Gymnasium id, an ``EnvSpec`` or an environment with a transition table, which is neither stepped nor
            closed. Observations show the whole state.
        policy: The policy whose values are approximated, in the forms of :func:`qtab.policy_values`.
        features: (states, d) or (*cells, d) floats: the feature vector of each state; or, as in
            :func:`qtab.estimate_values`, None for a table, (states,) or (states, n_active) integers: the active
            features in each state, or a function from an observation to its feature vector.
        discount: The discount γ, in [0, 1].
        trace_decay: λ, in [0, 1].
        behavior: The policy that chooses the actions, in the same forms; None means ``policy`` itself. It determines
            only the distribution of the states.
        distribution: (states,) or (*cells,): μ, the weight of each state. None means the fraction of time steps that
            ``behavior`` spends in each state in the long run.
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        MemoryError: if the matrices would take more than half of the machine's memory.
        OverflowError: if values exceed the range of float64.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, a distribution that does not sum to 1, a policy of the wrong shape or
            with probabilities that do not sum to 1, an environment without a transition table or whose observations
            hide part of the state, or a policy that collects rewards forever without a discount.
    """
    discount = checks.real("discount", discount, 0.0, 1.0)
    trace_decay = checks.real("trace_decay", trace_decay, 0.0, 1.0)
    if behavior is not None and distribution is not None:
        raise ValueError("distribution must be None with a behavior, which determines it")
    with opened_table(env, env_kwargs) as table:
        cells, solver, states = table.cells, table.solver, table.cells.n_rows
        if len(solver.rows) != states:
            raise ValueError(f"env must show its whole state, which the observations of {table.name} do not")
        if callable(features):
            features = features_of_function(features, cells, table.env.observation_space)
        matrix = feature_matrix(features, states, cells.shape)
        d = matrix.shape[1]
        check_memory(f"matrices of {d:,} x {d:,} numbers for {d:,} features", 8 * MATRICES * d**2)
        weights = None if distribution is None else _distribution(distribution, cells.shape)
        exact = policy_values(table.env, policy, discount)
        transitions, initial = solver.transitions(), solver.initial_distribution
        chosen = exact.probabilities.reshape(states, -1)
        chain = acting = chain_of(transitions, chosen, initial)
        if behavior is not None:
            of_behavior = probabilities("behavior", behavior, table.env.observation_space, cells, table.actions)
            acting = chain_of(transitions, of_behavior, initial)
    return LinearGeometry(
        env=table.name,
        discount=discount,
        trace_decay=trace_decay,
        features=matrix,
        distribution=acting.distribution if weights is None else weights,
        values=exact.values.ravel(),
        chain=chain,
    )


def _distribution(given: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    array = numbers("distribution", given)
    count = int(np.prod(shape))
    if array.shape not in (shape, (count,)):
        raise ValueError(f"distribution must have the shape {shape}, got {array.shape}")
    if (array < 0.0).any():
        raise ValueError(f"distribution must hold probabilities of at least 0, got {array.min():.6g}")
    if not abs(array.sum() - 1.0) <= SUM_TOLERANCE:
        raise ValueError(f"distribution must sum to 1, got {array.sum():.6g}")
    return array.ravel()
