"""Training on compiled environments gives what training in Python gives, to the last bit."""

import logging
import math
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from support.environments import own
from support.environments.gym_classes.grids import CliffEnv

pytest.importorskip("numba")

WITH_CELLS: dict[Any, dict[str, Any]] = {
    **{made: {} for made in (own.AccessControl, own.Bandit, own.Cliff, own.KeyAndDoor, own.RandomWalk)},
    **{made: {} for made in (own.SlipperyGrid, own.WindyGrid)},
    **{made: {} for made in (own.Elevator, own.Inventory, own.Queue, own.Taxi, own.TwentyOne)},  # nested spaces
    own.Robot: {"discretizer": "bins", "bins": 5},
    own.Epidemic: {"discretizer": "bins", "bins": 6},
    own.Gambler: {"action_mask": True},
    own.TicTacToe: {"action_mask": True},
    own.MountainCar: {"discretizer": "bins", "bins": 8},
    own.NoisyPendulum: {"discretizer": "bins", "bins": 4},
    own.CartPole: {"discretizer": "tiles", "tiles": 2, "tilings": 4},
    own.Thermostat: {"discretizer": "bins", "bins": 3},
}
"""The settings that each environment needs."""


def limited(made: Any, steps: int = 60) -> gym.Env[Any, Any]:
    return gym.wrappers.TimeLimit(made(), steps)


def trained(made: Any, backend: Any, **chosen: Any) -> qtab.Run:
    return qtab.train(limited(made), backend=backend, **WITH_CELLS[made], **{"episodes": 12, "seed": 3} | chosen)


def assert_same(one: qtab.Run, other: qtab.Run) -> None:
    assert one.tables.tobytes() == other.tables.tobytes()
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    assert one.episode_lengths.tobytes() == other.episode_lengths.tobytes()


@pytest.mark.parametrize("made", WITH_CELLS, ids=lambda made: made.__name__)
@settings(max_examples=4)
@given(seed=st.integers(0, 2**64))
def test_each_environment(made: Any, seed: int) -> None:
    compiled, python = (trained(made, backend, seed=seed) for backend in ("numba", "python"))
    assert (compiled.config.backend, python.config.backend) == ("rust", "gymnasium")
    assert_same(compiled, python)


@pytest.mark.parametrize("algorithm", ["q_learning", "sarsa", "expected_sarsa", "double_q_learning", "sarsa_lambda"])
@pytest.mark.parametrize("made", [own.KeyAndDoor, own.CartPole, own.TicTacToe], ids=lambda made: made.__name__)
def test_learners(made: Any, algorithm: Any) -> None:
    assert_same(*(trained(made, backend, algorithm=algorithm) for backend in ("numba", "python")))


def test_threads_and_callbacks_change_nothing() -> None:
    chosen: dict[str, Any] = {"episodes": 20, **WITH_CELLS[own.KeyAndDoor]}
    many = qtab.train_many(lambda: limited(own.KeyAndDoor), seeds=4, threads=2, tables=True, backend="numba", **chosen)
    for seed, run in enumerate(many):
        assert_same(run, trained(own.KeyAndDoor, "python", seed=seed, episodes=20))
    watched = trained(own.KeyAndDoor, "numba", callback=lambda progress: True, callback_every=7)
    assert_same(watched, trained(own.KeyAndDoor, "numba"))


def test_a_sweep() -> None:
    gym.register("own/Walk-v0", "support.environments.own:RandomWalk", max_episode_steps=60)
    try:
        grid = {"learning_rate": [0.1, 0.5]}
        one, other = (
            qtab.sweep("own/Walk-v0", grid, seeds=2, episodes=10, backend=backend) for backend in ("numba", "python")
        )
        assert one.failed == other.failed == 0
        assert one.mean_final_returns().tobytes() == other.mean_final_returns().tobytes()
    finally:
        del gym.registry["own/Walk-v0"]


def test_functions_that_take_a_run() -> None:
    env = limited(own.MountainCar)
    run, python = (trained(own.MountainCar, backend, record=2, visits=True) for backend in ("numba", "python"))
    assert qtab.verify(run, env=env).equal
    assert run.visits is not None
    assert run.visits.tobytes() == (python.visits if python.visits is not None else np.empty(0)).tobytes()
    for one, other in zip(run.recordings, python.recordings, strict=True):
        assert list(one.actions) == list(other.actions)
    evaluated = [qtab.evaluate(found, env=env, episodes=3, seed=5).returns.tobytes() for found in (run, python)]
    assert evaluated[0] == evaluated[1]
    assert "episode 1" in str(qtab.explain(run, env=env, episode=1))


def test_a_run_that_was_stopped_is_resumed() -> None:
    env = limited(own.TicTacToe)
    part = trained(own.TicTacToe, "numba", callback=lambda progress: False, callback_every=5)
    assert_same(qtab.resume(part, env=env), trained(own.TicTacToe, "numba"))


def test_values_are_estimated() -> None:
    one = qtab.estimate_values(limited(own.KeyAndDoor), "random", seeds=2, episodes=20)
    same = gym.wrappers.TransformReward(limited(own.KeyAndDoor), lambda reward: reward)  # it is stepped in Python
    for index, seed in enumerate(one.seeds):
        other = qtab.estimate_values(same, "random", seeds=[seed], episodes=20)
        assert one.weights[index].tobytes() == other.weights[0].tobytes()


def test_values_of_an_ordinary_class_are_estimated() -> None:
    one = qtab.estimate_values(limited(CliffEnv), "random", seeds=2, episodes=20, backend="numba")
    for index, seed in enumerate(one.seeds):
        other = qtab.estimate_values(limited(CliffEnv), "random", seeds=[seed], episodes=20)
        assert one.weights[index].tobytes() == other.weights[0].tobytes()
    assert one.verify(env=limited(CliffEnv)).equal
    with pytest.raises(ValueError, match=r"^backend must be .* got 'numba': Numba compiles your own classes"):
        qtab.estimate_values("FrozenLake-v1", "random", backend="numba")


class Spilling(own.RandomWalk):
    """Leaves the states of its observation space."""

    def transition(self, state: int, action: int, rng: np.random.Generator) -> Any:
        return state + 1, 0.0, False


class Breaking(own.RandomWalk):
    """Raises an error of its own."""

    def transition(self, state: int, action: int, rng: np.random.Generator) -> Any:
        if state == 15:
            raise RuntimeError("the walk is over")
        return state + 1, 0.0, False


class NotFinite(own.RandomWalk):
    """Has a reward that is no number in one state."""

    def transition(self, state: int, action: int, rng: np.random.Generator) -> Any:
        return state + 1, math.nan if state == 15 else 0.0, False


@pytest.mark.parametrize("backend", ["numba", "python"])
@pytest.mark.parametrize(
    ("made", "error", "message"),
    [
        (NotFinite, ValueError, "^transition of NotFinite must return a finite number as the reward, got nan$"),
        (Spilling, ValueError, "observe of Spilling must return an element of"),
        (Breaking, RuntimeError, "the walk is over"),
    ],
)
def test_an_error_of_the_environment_reaches_the_user(made: Any, error: Any, message: str, backend: Any) -> None:
    with pytest.raises(error, match=message):
        qtab.train(limited(made), backend=backend, episodes=3, seed=0)


class Choosing(own.RandomWalk):
    """Draws in a way that Numba does not have."""

    def initial_state(self, rng: np.random.Generator) -> int:
        return 1 + int(rng.choice(self.states))


def test_what_cannot_be_compiled_is_stepped_in_python_with_one_message(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "qtab"):
        runs = [qtab.train(limited(Choosing), episodes=3, seed=0) for _ in range(2)]
    assert runs[0].config.backend == "gymnasium"
    (message,) = [record.getMessage() for record in caplog.records if "Choosing" in record.getMessage()]
    assert "stepped in Python" in message
    assert f"{Path(__file__).name}:" in message  # a stored refusal has no folders
    assert "rng.choice(self.states) cannot be compiled; draw an index with rng.integers(0, n)" in message
    with pytest.raises(
        ValueError,
        match=r"^the environment cannot be compiled, as .*rng.choice.* cannot be compiled; draw an",
    ):
        qtab.train(limited(Choosing), episodes=3, backend="numba")


def test_numba_is_refused_where_it_is_not_used() -> None:
    with pytest.raises(ValueError, match=r"^backend must be .* got 'numba': Numba compiles .* qtab.FunctionalEnv"):
        qtab.train("MountainCar-v0", episodes=1, backend="numba")
    with pytest.raises(ValueError, match=r"^backend must be .* got 'numba': Numba compiles .* qtab.FunctionalEnv"):
        qtab.train(gym.make("Acrobot-v1").unwrapped.__class__(), episodes=1, backend="numba", discretizer="bins")
