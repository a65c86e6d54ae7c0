"""Values over the observations of a Box, by cells or tile coding: equal to plain NumPy, and near the truth."""

import dataclasses
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import qtab
from qtab.prediction import METHODS
from qtab.prediction.settings import OFF_POLICY
from qtab.prediction.verification import verify_values
from support.learners.box_prediction import CAR, FAST, PENDULUM, POLE, TILES, with_the_velocity

AVERAGES = ("importance_sampling", "batch_td")


def mostly_with_the_velocity(observation: NDArray[np.float32]) -> list[float]:
    return [0.7, 0.2, 0.1] if observation[1] < 0 else [0.1, 0.2, 0.7]


def towards_upright(observation: NDArray[np.float32]) -> int:
    return int(observation[2] + observation[3] > 0)


def swings(observation: NDArray[np.float32]) -> NDArray[np.float64]:
    return np.array([0.75, 0.0, 0.25]) if observation[2] < 0 else np.array([0.0, 0.5, 0.5])


ENVIRONMENTS: dict[str, tuple[list[Any], dict[str, Any]]] = {
    CAR: (["random", with_the_velocity, mostly_with_the_velocity], {}),
    POLE: (["random", towards_upright], {"low": [-2.4, -3.0, -0.2, -3.0], "high": [2.4, 3.0, 0.2, 3.0]}),
    PENDULUM: (["random", swings, lambda observation: 1], {"actions": 3}),
}
DISCRETIZERS: list[dict[str, Any]] = [
    TILES,
    {**TILES, "hashed_rows": 50},
    {"discretizer": "tiles", "tilings": 3, "tiles": 2},
    {"discretizer": "bins", "bins": 3},
]


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=settings().max_examples // 6)
@given(data=st.data())
def test_any_settings_equal_plain_numpy(method: Any, data: st.DataObject) -> None:
    env = data.draw(st.sampled_from(list(ENVIRONMENTS)))
    policies, options = ENVIRONMENTS[env]
    arguments = dict(data.draw(st.sampled_from(DISCRETIZERS[-1:] if method in AVERAGES else DISCRETIZERS)))
    cells = arguments["discretizer"] == "bins"
    if method in ("td", "n_step_td", "monte_carlo"):
        arguments["learning_rate"] = data.draw(st.none() | st.floats(0.0, 1.0))
    elif method not in (*AVERAGES, "lstd"):
        # Emphases grow to thousands within an episode.
        arguments["learning_rate"] = data.draw(st.floats(0.0, 1e-3 if method == "emphatic_td" else 1.0))
    if method in ("gtd2", "tdc"):
        arguments["second_learning_rate"] = data.draw(st.floats(0.0, 1.0))
    if arguments.get("learning_rate") is not None and data.draw(st.booleans()):
        arguments["learning_rate_schedule"] = "linear"
    if method == "n_step_td":
        arguments["n_steps"] = data.draw(st.integers(1, 30) | st.just(2000))
    if "lambda" in method:
        arguments["trace_decay"] = data.draw(st.floats(0.0, 1.0))
    if method in OFF_POLICY:
        arguments["behavior"] = "random"
    if method == "importance_sampling":
        arguments["weighted"] = data.draw(st.booleans())
    if method in ("importance_sampling", "monte_carlo") and cells:
        arguments["first_visit"] = data.draw(st.booleans())
    found = qtab.estimate_values(
        env,
        data.draw(st.sampled_from(policies)),
        method=method,
        episodes=2,
        # Without a discount, batch TD does not settle before it has seen a terminal state.
        discount=data.draw(st.sampled_from([0.0, 0.9] if method == "batch_td" else [0.0, 0.9, 1.0])),
        initial_value=data.draw(st.sampled_from([0.0] if method == "lstd" else [0.0, -5.0])),
        max_episode_steps=data.draw(st.sampled_from([5, 40])),
        on_truncation=data.draw(st.sampled_from(["bootstrap", "terminate"])),
        bit_generator=data.draw(st.sampled_from(["PCG64", "MT19937"])),
        seeds=[data.draw(st.integers(0, 1000))],
        **options,
        **arguments,
    )
    assert found.verify().equal


@pytest.mark.parametrize("policy", ["random", with_the_velocity])
def test_the_seeds_and_threads_do_not_change_a_run(policy: Any) -> None:
    one = qtab.estimate_values(CAR, policy, seeds=[4], threads=1, **FAST, **TILES)
    many = qtab.estimate_values(CAR, policy, seeds=6, threads=3, **FAST, **TILES)
    assert np.array_equal(one.weights[0], many.weights[4])
    assert len({weights.tobytes() for weights in many.weights}) == 6


def test_a_policy_sees_the_observations_themselves() -> None:
    seen = []

    def policy(observation: NDArray[np.float32]) -> int:
        seen.append(observation)
        return 2

    qtab.estimate_values(CAR, policy, episodes=1, max_episode_steps=9, learning_rate=0.1)
    env = gym.make(CAR)
    expected = [env.reset(seed=0)[0], *(env.step(2)[0] for _ in range(8))]
    assert np.array_equal(seen, expected)
    assert {observation.dtype for observation in seen} == {np.dtype(np.float32)}


def test_the_values_of_a_policy_without_chance_come_near_its_returns() -> None:
    found = qtab.estimate_values(
        CAR, with_the_velocity, method="monte_carlo", episodes=300, record=300, seeds=2, discretizer="tiles"
    )
    env: Any = gym.make(CAR).unwrapped
    starts = np.array([[-0.6, 0.0], [-0.5, 0.0], [-0.45, 0.0]], np.float32)

    def its_return(observation: Any) -> float:
        state, steps, over = observation, 0, False
        env.reset()
        env.state = tuple(observation.tolist())
        while not over:
            state, _, over, _, _ = env.step(with_the_velocity(state))
            steps += 1
        return -float(steps)

    assert found.value(starts).shape == (2, 3)
    exact = [its_return(start) for start in starts]
    assert (found.rms_error(exact, observations=starts) < 12).all()
    assert np.array_equal(
        found.rms_error(exact, [1, 2, 0], observations=starts),
        found.rms_error(its_return, [1, 2, 0], observations=starts),
    )


def test_the_value_of_an_observation_is_that_of_its_cell_or_the_sum_of_its_tiles() -> None:
    observations = np.array([[-0.5, 0.0], [0.3, 0.05]], np.float32)
    cells = qtab.estimate_values(CAR, "random", seeds=2, **FAST)
    run = qtab.train(CAR, seed=0, episodes=1)
    for index, observation in enumerate(observations):
        first, second = run.discretizer.cell(observation)
        expected = cells.values[:, first, second]
        assert np.array_equal(cells.value(observation), expected)
        assert np.array_equal(cells.value(observations)[:, index], expected)
    tiles = qtab.estimate_values(CAR, "random", seeds=2, **FAST, **TILES)
    assert tiles.discretizer is not None
    total = np.zeros(2)
    for row in tiles.discretizer.active_rows(observations[0]):
        total = total + tiles.weights[:, -1, row]
    assert np.array_equal(tiles.value(observations[0]), total)
    grouped = qtab.estimate_values(CAR, with_the_velocity, seeds=2, features=np.arange(285) // 15, **FAST)
    assert np.array_equal(
        grouped.value(observations[0]), grouped.value(observations[0] + np.array([0, 0.03], np.float32))
    )


@pytest.mark.parametrize("discretizer", [{}, TILES])
@pytest.mark.parametrize("settings", [{"discretizer": "tiles"}, {"algorithm": "double_q_learning"}])
def test_a_run_acts_greedily_whatever_divides_its_observations(settings: Any, discretizer: Any) -> None:
    run = qtab.train(CAR, seed=1, episodes=20, learning_rate=0.5, discount=1.0, terminal_update="target", **settings)
    found = qtab.estimate_values(CAR, run, **FAST, **discretizer)
    assert found.verify().equal
    by_hand = qtab.estimate_values(
        CAR, lambda observation: run.predict(observation)[0], **FAST, **(discretizer or settings_of(run))
    )
    assert np.array_equal(found.weights, by_hand.weights)


def settings_of(run: qtab.Run) -> dict[str, Any]:
    names = ("discretizer", "tilings", "tiles", "low", "high") if run.config.discretizer == "tiles" else ("scale",)
    return {name: getattr(run.config, name) for name in names}


@pytest.mark.slow
def test_an_optimum_acts_by_the_observation() -> None:
    best = qtab.optimum(CAR)
    found = qtab.estimate_values(CAR, best, **FAST, **TILES)
    assert found.verify().equal
    by_hand = qtab.estimate_values(CAR, lambda observation: best.predict(observation)[0], **FAST, **TILES)
    assert np.array_equal(found.weights, by_hand.weights)


class FullTorque:
    """Stands for the search of Pendulum's best policy, which takes seconds."""

    needs_step_count = False
    observation_shape = (3,)

    def in_rows(self, observation: Any) -> Any:
        return observation

    def action(self, observation: NDArray[np.float32], steps_taken: int) -> NDArray[np.float32]:
        return np.array([2.0 if observation[2] + steps_taken > 0 else -2.0], np.float32)


def test_the_torques_of_an_optimum_find_their_columns() -> None:
    solver: Any = FullTorque()
    details: dict[str, Any] = {"search": "found", "solver": solver, "q_values": np.zeros((1, 1, 21))}
    for field in dataclasses.fields(qtab.Optimum):
        details.setdefault(field.name, None)
    best = qtab.Optimum(**details)
    found = qtab.estimate_values(PENDULUM, best, actions=[-2.0, 2.0], **FAST, **TILES)
    assert found.verify().equal
    with pytest.raises(ValueError, match=r"actions must hold those of the optimum, .* got <Actions: 1, .*: actions=21"):
        qtab.estimate_values(PENDULUM, best, actions=[0.0], **FAST, **TILES)


class Corridor(gym.Env[Any, Any]):
    """A step of random length to either side, from 0 to the ends at -1 and 1."""

    action_space = gym.spaces.Discrete(2, start=5)
    at = 0.0

    def __init__(self, dtype: Any = np.float64) -> None:
        self.observation_space = gym.spaces.Box(-2.0, 2.0, (1,), dtype)

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        super().reset(seed=seed)
        self.at = 0.0
        return self.observe(), {}

    def observe(self) -> NDArray[Any]:
        return np.array([self.at], self.observation_space.dtype)

    def step(self, action: int) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        self.at += (2 * action - 11) * 0.3 * self.np_random.random()
        return self.observe(), -1.0, abs(self.at) >= 1, False, {}


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(
    ("policy", "options"),
    [
        ("random", {"method": "true_online_td_lambda", "trace_decay": 0.8, "learning_rate": 0.5, **TILES}),
        (lambda at: 5 if at[0] < 0 else 6, {"method": "monte_carlo", **TILES}),
        (
            lambda at: 5 if at[0] < 0 else 6,
            {"method": "importance_sampling", "behavior": lambda at: [0.4, 0.6], "discretizer": "bins"},
        ),
        (np.full(4, 6), {"method": "importance_sampling", "behavior": lambda at: [0.4, 0.6], "bins": 4}),
    ],
)
def test_an_environment_in_python_is_stepped_there(dtype: Any, policy: Any, options: Any) -> None:
    arguments = {"discretizer": "bins", **options}
    found = qtab.estimate_values(Corridor(dtype), policy, episodes=5, **arguments)
    assert verify_values(found, None, None, gym.wrappers.TimeLimit(Corridor(dtype), 10_000)).equal
    run = qtab.train(Corridor(dtype), seed=0, episodes=3, discretizer="tiles", terminal_update="target")
    greedy = qtab.estimate_values(Corridor(dtype), run, episodes=3, learning_rate=0.1, max_episode_steps=30)
    assert verify_values(greedy, None, None, gym.wrappers.TimeLimit(Corridor(dtype), 30)).equal


def test_importance_sampling_by_observations_agrees_with_tables() -> None:
    # Bins that end at velocity 0, so that the function is a table as well.
    cells: dict[str, Any] = {"discretizer": "edges", "edges": [[-0.5], [0.0]]}
    arguments: dict[str, Any] = {"method": "importance_sampling", "behavior": "random", "seeds": 2, **cells}
    by_function = qtab.estimate_values(CAR, with_the_velocity, episodes=3, max_episode_steps=50, **arguments)
    table = np.array([[0, 2], [0, 2]])
    by_table = qtab.estimate_values(CAR, table, episodes=3, max_episode_steps=50, **arguments)
    assert by_function.probabilities is None
    assert np.array_equal(by_function.weights, by_table.weights)
