"""Pictures of observations that are not plain Boxes: paths lie along the axes, and maps show states alone."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces
from matplotlib.figure import Figure

import qtab
from qtab import plots


class Diagonal(gym.Env[Any, Any]):
    """Counts to four, and shows the number in an observation of any space."""

    action_space = spaces.Discrete(2)

    def __init__(self, space: Any, observation: Any) -> None:
        self.observation_space, self.observation, self.step_count = space, observation, 0

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        super().reset(seed=seed)
        self.step_count = 0
        return self.observation(0), {}

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        self.step_count += 1
        return self.observation(self.step_count), -1.0, self.step_count == 4, False, {}


SQUARE = spaces.Box(0, 5, (2, 2), np.int64)
NESTED = spaces.Dict(a=spaces.Discrete(6), b=spaces.Tuple([spaces.Box(0, 5, (2,), np.int64)]))


@pytest.mark.parametrize(
    ("space", "observation", "options", "point"),
    [
        (SQUARE, lambda k: np.array([[k, 5 - k], [0, 0]]), {}, lambda k: (k, 5 - k)),
        (NESTED, lambda k: {"a": k, "b": (np.array([5 - k, 0]),)}, {}, lambda k: (k, 5 - k)),
        (SQUARE, lambda k: np.full((2, 2), k), {"max_rows": 9}, lambda k: (k, 0.5)),
        (
            spaces.Text(5),
            lambda k: "a" * k,
            {"discretizer": lambda text: (4 - len(text), len(text)), "shape": (5, 5)},
            lambda k: (4 - k, k),
        ),
    ],
)
def test_a_path_lies_along_the_axes(space: Any, observation: Any, options: dict[str, Any], point: Any) -> None:
    env = Diagonal(space, observation)
    run = qtab.train(env, episodes=3, seed=0, max_episode_steps=9, **options)
    lines: Any = plots.trajectory(run, Figure().subplots(), env=env, episodes=1).lines
    path = max(lines, key=lambda line: np.size(line.get_xdata()))
    np.testing.assert_array_equal(path.get_xydata(), [point(k) for k in range(5)])


@pytest.mark.parametrize(
    "options",
    [{"discretizer": lambda state: 15 - state, "shape": 16}, {"max_rows": 15}, {"max_rows": 100}],
    ids=["function", "as many rows as states", "more rows"],
)
def test_rows_that_are_not_states_are_not_drawn_on_the_map(options: dict[str, Any]) -> None:
    run = qtab.train("FrozenLake-v1", episodes=5, seed=0, **options)
    ax = plots.values(run, Figure().subplots())
    assert ax.get_xlabel() != "column"
    assert ax.get_xlim() == (-0.5, len(run.q_table) - 0.5)
    plots.trajectory(run, Figure().subplots(), episodes=1)


def test_a_wrapper_that_merges_states_leaves_the_map() -> None:
    lake = gym.make("FrozenLake-v1")
    rows = gym.wrappers.TransformObservation(lake, lambda state: state // 4, spaces.Discrete(4))
    run = qtab.train(rows, episodes=5, seed=0)
    assert plots.values(run, Figure().subplots()).get_xlim() == (-0.5, 3.5)


def test_indices_of_a_function_are_not_drawn_as_angles() -> None:
    run = qtab.train("Pendulum-v1", discretizer=lambda _: (1, 1, 1), shape=(3, 3, 3), actions=2, episodes=1, seed=0)
    assert plots.values(run, Figure().subplots()).get_xlim() == (-0.5, 2.5)


def test_the_states_of_an_optimum_are_numbered_as_the_environment_numbers_them() -> None:
    ahead = {state: {0: [(1.0, min(state + 1, 3), -1.0, state == 3)]} for state in range(4)}
    env = qtab.TabularEnv(ahead, [1.0, 0.0, 0.0, 0.0])
    env.observation_space = spaces.Discrete(4, start=1)
    best = qtab.optimum(env)
    assert plots.values(best, Figure().subplots()).get_xlim() == (0.5, 4.5)
