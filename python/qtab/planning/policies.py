"""A given policy as a table of probabilities: from an array, a function, a run, an optimum, or its name."""

from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils.shown import did_you_mean, shown
from qtab.discretizers import Discretizer
from qtab.envs.actions import Actions
from qtab.planning.optimum import Optimum
from qtab.results.run import Run

RANDOM = "random"
"""The name of the policy that takes every action with the same probability."""
SUM_TOLERANCE = 1e-9
"""The largest deviation of a state's probabilities from a sum of 1, as in transition tables."""

GivenPolicy: TypeAlias = ArrayLike | Callable[[Any], Any] | Run | Optimum | str
"""The accepted forms of a policy; see :func:`probabilities`."""


def probabilities(
    name: str, policy: GivenPolicy, space: gym.Space[Any] | None, cells: Discretizer, actions: Actions
) -> NDArray[np.float64]:
    """Returns (rows, actions) float64: the probability of each action in each cell of the observations.

    Args:
        name: The name of the argument, for messages.
        policy: ``"random"`` for equal probabilities; an array (*cells,) of actions or (*cells, actions) of
            probabilities, in which a single axis may replace those of the cells; a function from an observation to an
            action or to (actions,) probabilities; a run, for its greedy policy; or an optimum that does not depend on
            the steps left.
        space: The observation space, needed only for a function.
        cells: The cells of the observations.
        actions: The actions.

    Raises:
        TypeError: if ``policy`` is none of these.
        ValueError: for a wrong shape, an action that does not exist, a negative probability, or probabilities that do
            not sum to 1.
    """
    if isinstance(policy, str):
        return equal_probabilities(name, policy, cells.n_rows, len(actions))
    if isinstance(policy, Run):
        return _of_run(name, policy, cells, actions)
    if isinstance(policy, Optimum):
        if policy.solver.needs_step_count:
            raise ValueError(
                f"{name} must not depend on the steps left, got an optimum by {policy.method!r}; method "
                "'policy_iteration' gives one that does not"
            )
        return of_array(name, policy.policy, cells, actions)
    if callable(policy):
        return _of_function(name, policy, space, cells, actions)
    return of_array(name, policy, cells, actions)


def equal_probabilities(name: str, policy: str, rows: int, n_actions: int) -> NDArray[np.float64]:
    """Returns (rows, actions): the probabilities of the named policy. The only name is ``"random"``.

    Raises:
        ValueError: for any other name.
    """
    if policy != RANDOM:
        raise ValueError(f"{name} must be 'random' or a policy, got {shown(policy)}{did_you_mean(policy, [RANDOM])}")
    return np.full((rows, n_actions), 1.0 / n_actions)


def of_array(name: str, policy: ArrayLike, cells: Discretizer, actions: Actions) -> NDArray[np.float64]:
    """Returns (rows, actions): the probabilities of an array of actions or of probabilities.

    Raises:
        TypeError: if it does not hold numbers.
        ValueError: as :func:`probabilities` does.
    """
    try:
        array = np.asarray(policy)
    except ValueError:  # rows of different lengths
        array = np.asarray(None)
    if array.dtype.kind not in "iuf":
        raise TypeError(
            f"{name} must be an array of actions or of probabilities, a function, a run, an optimum or 'random', "
            f"got {shown(policy)}"
        )
    shape, count = cells.shape, len(actions)
    if array.shape in (shape, (cells.n_rows,)):
        return _of_actions(name, array.ravel(), actions)
    if array.shape not in ((*shape, count), (cells.n_rows, count)):
        raise ValueError(
            f"{name} must have the shape {shape} of actions or {(*shape, count)} of probabilities, got {array.shape}"
        )
    return _distributions(name, array.astype(np.float64).reshape(cells.n_rows, count))


def _distributions(name: str, table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns (rows, actions) probabilities, checked.

    Raises:
        ValueError: if a row is not a distribution over the actions.
    """
    if not (table >= 0.0).all():
        row = int(np.flatnonzero(~(table >= 0.0).all(axis=1))[0])
        raise ValueError(f"{name} must hold probabilities of at least 0, got {shown(table[row].tolist())} in row {row}")
    sums = table.sum(axis=1)
    wrong = np.flatnonzero(~(np.abs(sums - 1.0) <= SUM_TOLERANCE))
    if len(wrong):
        raise ValueError(f"{name} must sum to 1 in every state, got {sums[wrong[0]]:.6g} in row {wrong[0]}")
    return table


def as_followed(table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns (rows, actions) probabilities as an agent follows them: exactly 1 if only one action is possible."""
    possible = table > 0.0
    return possible.astype(np.float64) if (possible.sum(axis=1) == 1).all() else table


def _of_actions(name: str, chosen: NDArray[Any], actions: Actions) -> NDArray[np.float64]:
    """The probabilities of a deterministic policy, given by the actions as the environment numbers them."""
    if chosen.dtype.kind not in "iu":
        raise TypeError(f"{name} must hold integers if it has an action for each state, got dtype {chosen.dtype}")
    columns = chosen.astype(np.int64) - actions.first
    wrong = (columns < 0) | (columns >= len(actions))
    if wrong.any():
        last = actions.first + len(actions) - 1
        raise ValueError(f"{name} must hold actions from {actions.first} to {last}, got {chosen[wrong][0]}")
    table = np.zeros((len(columns), len(actions)))
    table[np.arange(len(columns)), columns] = 1.0
    return table


def refuse_time_aware(name: str, run: Run) -> None:
    """Rejects a run whose policy depends on the number of steps taken."""
    if run.config.time_aware:
        raise ValueError(
            f"{name} must not depend on the number of steps taken, got a run with time_aware=True; "
            "run.at_step(step) has the policy of one step"
        )


def _of_run(name: str, run: Run, cells: Discretizer, actions: Actions) -> NDArray[np.float64]:
    refuse_time_aware(name, run)
    expected, found = (*cells.shape, len(actions)), (*run.discretizer.shape, len(run.actions))
    if not run.discretizer.has_cells:
        raise ValueError(f"{name} must be a run with a table of shape {expected}, got one without: {run.discretizer!r}")
    if found != expected:
        raise ValueError(f"{name} must be a run with a table of shape {expected}, got {found}")
    best = np.argmax(run.q_table, axis=-1).ravel() + actions.first
    return _of_actions(name, best, actions)


def _of_function(
    name: str, policy: Callable[[Any], Any], space: gym.Space[Any] | None, cells: Discretizer, actions: Actions
) -> NDArray[np.float64]:
    if not isinstance(space, gym.spaces.Discrete | gym.spaces.MultiDiscrete | gym.spaces.Tuple):
        raise ValueError(f"{name} must be an array for observations that are not discrete, got a function")
    table = np.empty((cells.n_rows, len(actions)))
    for row, observation in enumerate(discrete_observations(space, cells)):
        table[row] = answered(name, policy(observation), observation, actions)
    return _distributions(name, table)


def discrete_observations(space: gym.Space[Any], cells: Discretizer) -> Iterator[Any]:
    """Yields the observation of each row, as the environment with this Discrete, MultiDiscrete or Tuple space does."""
    first = cells.low.reshape(-1)
    for row in range(cells.n_rows):
        numbers = np.array(np.unravel_index(row, cells.shape)) + first
        if isinstance(space, gym.spaces.Tuple):
            yield tuple(numbers.tolist())
        elif isinstance(space, gym.spaces.MultiDiscrete):
            yield numbers.astype(space.dtype)
        else:
            yield int(numbers[0])


def answered(name: str, answer: Any, observation: Any, actions: Actions) -> list[float]:
    """Returns (actions,): the probabilities from a function's return value, which is an action or probabilities.

    Raises:
        TypeError: if the value does not hold numbers.
        ValueError: for an action that does not exist, or probabilities that are not a distribution over the actions.
    """
    first, count = actions.first, len(actions)
    where = f"for the observation {shown(np.asarray(observation).tolist())}"
    try:
        given = np.asarray(answer)
    except ValueError:  # lists of different lengths
        given = np.asarray(None)
    if given.shape == () and given.dtype.kind in "iu":
        if not first <= given < first + count:
            raise ValueError(f"{name} must return actions from {first} to {first + count - 1}, got {given} {where}")
        return [float(action == given) for action in range(first, first + count)]
    if given.shape != (count,) or given.dtype.kind not in "iuf":
        kind = ValueError if given.dtype.kind in "iuf" and given.shape else TypeError
        raise kind(f"{name} must return the number of an action or {count} probabilities, got {shown(answer)} {where}")
    if not (given >= 0).all() or not abs(float(given.sum()) - 1.0) <= SUM_TOLERANCE:
        raise ValueError(
            f"{name} must return probabilities of at least 0 that sum to 1, got {shown(given.tolist())} {where}"
        )
    return [float(number) for number in given]
