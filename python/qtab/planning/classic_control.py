"""The best known policies of classic control: value iteration on a grid, and searches over the exact dynamics."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab import _core
from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.planning.aggregation import aggregated_run
from qtab.planning.grid_environments import GridEnvironment
from qtab.planning.search import Search
from qtab.results.run import Run
from qtab.training.evaluate import evaluate

EVALUATION_EPISODES = 1000
"""The number of episodes, with seed 0, from which the return of a greedy policy is estimated."""
KEPT_SEARCHES = 2
"""The number of cached searches, about 50 MB each: ``gap`` after ``optimum`` need not search again."""


def search_grid(
    env: Any, known: GridEnvironment, max_episode_steps: int, on_values: Callable[[], None]
) -> tuple[_core.GridSearch, Search]:
    """Searches for the best policy of an environment, or returns the cached result of the same search.

    Args:
        env: The environment, unwrapped.
        known: The description of the environment, with the parameters of the search.
        max_episode_steps: The time limit in steps.
        on_values: Called between the two stages, when the values on the grid are known.

    Raises:
        ValueError: if a constant is not finite, or makes the environment random.
    """
    constants = tuple((name, checks.finite(name, getattr(env, name))) for name in _constants(known))
    for name, value in known.fixed.items():
        if not np.array_equal(getattr(env, name), value):
            raise ValueError(f"{name} must be {value} for method 'search', got {shown(getattr(env, name))}")
    flags = tuple((name, bool(getattr(env, name) == value)) for name, value in known.flags.items())
    key = np.array([number for _, number in constants], np.float64).tobytes()  # -0.0 is not 0.0
    searched = _values(known, key, flags, max_episode_steps)
    on_values()
    return searched, _episodes(searched, known)


def _constants(known: GridEnvironment) -> list[str]:
    return [name for name in _core.parameter_names(known.name) if name not in {*known.flags, *known.fixed}]


@lru_cache(KEPT_SEARCHES)
def _values(
    known: GridEnvironment, constants: bytes, flags: tuple[tuple[str, bool], ...], max_episode_steps: int
) -> _core.GridSearch:
    parameters = list(zip(_constants(known), np.frombuffer(constants).tolist(), strict=True))
    return _core.GridSearch(known.name, parameters, flags, max_episode_steps)


@lru_cache(KEPT_SEARCHES)
def _episodes(searched: _core.GridSearch, known: GridEnvironment) -> Search:
    """Follows the policy from each start state, and searches for a better route if there is a goal."""
    starts = known.starts
    greedy = searched.rollouts(starts)
    routes: list[NDArray[np.uint8] | None] = [None] * len(starts)
    returns, steps = greedy
    if known.beam:
        routes, (returns, steps) = searched.routes(starts, known.beam)
    found = Search(
        starts=starts[:, 0].copy() if known.starts_at_rest else starts.copy(),
        steps=steps,
        returns=returns,
        routes=tuple(routes),
        predict_return=float(greedy[0].mean()),
        axes=tuple(searched.axes()),
    )
    shared: list[NDArray[Any]] = [found.starts, found.steps, found.returns, *found.axes]
    for array in shared + [route for route in routes if route is not None]:
        array.flags.writeable = False  # several optima share them
    return found


class GridSolver:
    """Acts greedily with respect to the values on a grid, and evaluates the policies of runs by simulation."""

    needs_step_count = False

    def __init__(self, searched: _core.GridSearch, known: GridEnvironment, search: Search) -> None:
        self._searched = searched
        self._known = known
        self._axes = search.axes
        self._torques = searched.torques()

    @property
    def observation_shape(self) -> tuple[int, ...]:
        """The shape of an observation."""
        return (self._known.observation_length,)

    def in_rows(self, observation: Any) -> Any:
        """Returns the observation unchanged, as it is from a Box."""
        return observation

    def action(self, observation: ArrayLike, steps_taken: int) -> Any:  # noqa: ARG002 - see needs_step_count
        """Returns the best action: an integer, or for Pendulum a (1,) float32 torque.

        Raises:
            ValueError: if the observation has another shape, or is not finite.
        """
        numbers = np.asarray(observation, dtype=np.float64)
        if numbers.shape != self.observation_shape or not np.isfinite(numbers).all():
            raise ValueError(f"observation must be {self._known.observation}, got {observation!r}")
        index = self._searched.action(self._known.state_of(numbers).tolist())
        return self._torques[index : index + 1].copy() if len(self._torques) else index

    @property
    def has_continuous_actions(self) -> bool:
        """Whether the actions are chosen from a Box, such as Pendulum's torques."""
        return len(self._torques) > 0

    def greedy_return(self, run: Run) -> tuple[float, float]:
        """Returns the mean return of a run's greedy policy over 1,000 episodes, and its standard error."""
        evaluation = evaluate(run, EVALUATION_EPISODES, seed=0, progress=False)
        return evaluation.mean_return, evaluation.standard_error

    def attainable_return(self, run: Run) -> float | None:
        """Returns the mean return of the best policy known on the cells of a run; None for a run without cells."""
        aggregated = aggregated_run(run, self._known, self._axes)
        return None if aggregated is None else self.greedy_return(aggregated)[0]
