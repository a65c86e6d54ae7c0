"""The best known policies of classic control: value iteration on a grid, and searches over the exact dynamics."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from gymnasium.envs.classic_control import AcrobotEnv, CartPoleEnv, MountainCarEnv, PendulumEnv
from numpy.typing import ArrayLike, NDArray

from qtab import _core
from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.envs import classic_control as rust
from qtab.planning.search import Search
from qtab.results.run import Run
from qtab.training.evaluate import evaluate

EVALUATION_EPISODES = 1000
"""The return of a greedy policy is estimated from this many episodes, with seed 0."""
KEPT_SEARCHES = 2
"""The results of so many searches are kept, about 50 MB each: ``gap`` after ``optimum`` need not search again."""


@dataclass(frozen=True, eq=False)
class GridEnvironment:
    """An environment whose best known policy is found on a grid over its states."""

    name: str
    """Its name in Rust."""
    classes: tuple[type, ...]
    """Gymnasium's class and ours."""
    starts: NDArray[np.float64]
    """(starts, components): states that cover Gymnasium's range of start states evenly."""
    state_of: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    """The components of the state that an observation shows."""
    observation: str
    """What an observation is, for messages."""
    observation_length: int
    """The number of its components."""
    beam: int = 0
    """How many states the search for a route keeps after each step; 0 where there is no goal."""
    starts_at_rest: bool = False
    """Whether the starts are given as their first component alone."""
    flags: Mapping[str, Any] = field(default_factory=dict)
    """The value of each attribute of two values that Rust calls true."""
    fixed: Mapping[str, Any] = field(default_factory=dict)
    """Constants that the search takes for granted."""


def _evenly(low: ArrayLike, high: ArrayLike, count: int) -> NDArray[np.float64]:
    """Returns (count, components) points that cover a box evenly, by an additive recurrence.

    M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
    """
    lower, upper = np.array(low), np.array(high)
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (len(lower) + 1))
    steps = root ** -np.arange(1.0, len(lower) + 1)
    return np.asarray(lower + (upper - lower) * ((0.5 + np.arange(1, count + 1)[:, None] * steps) % 1.0))


def _midpoints(low: float, high: float, count: int) -> NDArray[np.float64]:
    """Returns (count, 2) states at rest: the midpoints of equal parts of a range of positions."""
    positions = low + (high - low) * ((np.arange(count) + 0.5) / count)
    return np.stack((positions, np.zeros(count)), axis=1)


def _of_pendulum(observation: NDArray[np.float64]) -> NDArray[np.float64]:
    cosine, sine, speed = observation
    return np.array([np.arctan2(sine, cosine), speed])


def _of_acrobot(observation: NDArray[np.float64]) -> NDArray[np.float64]:
    cosine1, sine1, cosine2, sine2, *speeds = observation
    return np.array([np.arctan2(sine1, cosine1), np.arctan2(sine2, cosine2), *speeds])


def _itself(observation: NDArray[np.float64]) -> NDArray[np.float64]:
    return observation


# A beam of 1,024 shortens MountainCar's routes by a hundredth of a step and takes a hundred times as long; one of 256
# shortens Acrobot's by one step.
ENVIRONMENTS = (
    GridEnvironment(
        "MountainCar",
        (MountainCarEnv, rust.MountainCarEnv),
        _midpoints(-0.6, -0.4, 1000),
        _itself,
        "a position and a velocity",
        2,
        beam=16,
        starts_at_rest=True,
    ),
    GridEnvironment(
        "CartPole",
        (CartPoleEnv, rust.CartPoleEnv),
        _evenly([-0.05] * 4, [0.05] * 4, 1000),
        _itself,
        "position, velocity, angle and angular velocity",
        4,
        flags={"kinematics_integrator": "euler", "_sutton_barto_reward": True},
    ),
    GridEnvironment(
        "Acrobot",
        (AcrobotEnv, rust.AcrobotEnv),
        _evenly([-0.1] * 4, [0.1] * 4, 200).astype(np.float32).astype(np.float64),
        _of_acrobot,
        "cosine and sine of both angles and both angular velocities",
        6,
        beam=64,
        flags={"book_or_nips": "nips"},
        fixed={"torque_noise_max": 0.0, "AVAIL_TORQUE": [-1.0, 0.0, 1.0]},
    ),
    GridEnvironment(
        "Pendulum",
        (PendulumEnv, rust.PendulumEnv),
        _evenly([-np.pi, -1.0], [np.pi, 1.0], 1000),
        _of_pendulum,
        "cosine and sine of the angle and the angular velocity",
        3,
    ),
)


def grid_environment(env: Any) -> GridEnvironment | None:
    """Returns how the best policy of an environment is searched; None for an environment of another class."""
    return next((known for known in ENVIRONMENTS if type(env) in known.classes), None)


def search_grid(
    env: Any, known: GridEnvironment, max_episode_steps: int, on_values: Callable[[], None]
) -> tuple[_core.GridSearch, Search]:
    """Searches the best policy of an environment, or returns what the same search found before.

    Args:
        env: The environment, unwrapped.
        known: How it is searched.
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
    """Follows the policy from each start state, and searches a better route where there is a goal."""
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

    def __init__(self, searched: _core.GridSearch, known: GridEnvironment) -> None:
        self._searched = searched
        self._known = known
        self._torques = searched.torques()

    @property
    def observation_shape(self) -> tuple[int, ...]:
        """The shape of an observation."""
        return (self._known.observation_length,)

    def action(self, observation: ArrayLike, steps_taken: int) -> Any:  # noqa: ARG002 - see needs_step_count
        """Returns the best action: an integer, or of Pendulum a (1,) float32 torque.

        Raises:
            ValueError: if the observation has another shape, or is not finite.
        """
        numbers = np.asarray(observation, dtype=np.float64)
        if numbers.shape != self.observation_shape or not np.isfinite(numbers).all():
            raise ValueError(f"observation must be {self._known.observation}, got {observation!r}")
        index = self._searched.action(self._known.state_of(numbers).tolist())
        return self._torques[index : index + 1].copy() if len(self._torques) else index

    def greedy_return(self, run: Run) -> tuple[float, float]:
        """Returns the mean return of a run's greedy policy over 1,000 episodes, and its standard error."""
        evaluation = evaluate(run, EVALUATION_EPISODES, seed=0, progress=False)
        return evaluation.mean_return, evaluation.standard_error
