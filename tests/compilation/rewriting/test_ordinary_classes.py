"""Ordinary Gymnasium classes in compiled code: training equals Python's to the bit, and errors are the user's."""

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.compilation.cache.store import Store
from qtab.compilation.interface.compiled_env import Stepper
from qtab.compilation.ordinary import OrdinaryEnv
from qtab.compilation.twins.class_twin import ClassTwin
from support.environments.gym_classes import control, failing, games, grids, operations

pytest.importorskip("numba")

TRAINED: dict[str, tuple[Callable[[], gym.Env], dict[str, Any]]] = {
    "cliff": (grids.CliffEnv, {}),
    "masks": (grids.MaskedGridEnv, {"action_mask": True}),
    "key and door": (grids.KeyDoorEnv, {}),
    "thermostat": (control.ThermostatEnv, {"discretizer": "bins", "bins": 8}),
    "pendulum": (control.PendulumEnv, {"discretizer": "bins", "bins": 6}),
    "inventory": (operations.InventoryEnv, {}),
    "machine": (operations.MachineEnv, {}),
    "tic-tac-toe": (games.TicTacToeEnv, {"action_mask": True}),
}


@pytest.fixture(autouse=True)
def _files_of_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name == "cliff" else pytest.mark.slow) for name in TRAINED]
)
def test_training_in_compiled_code_equals_training_in_python(name: str) -> None:
    make, settings = TRAINED[name]
    shared: dict[str, Any] = {"episodes": 60, "max_episode_steps": 100, "seed": 5, **settings}
    compiled = qtab.train(make(), backend="numba", **shared)
    python = qtab.train(make(), backend="gymnasium", **shared)
    assert compiled.episode_returns.tobytes() == python.episode_returns.tobytes()
    assert compiled.episode_lengths.tobytes() == python.episode_lengths.tobytes()
    assert compiled.tables.tobytes() == python.tables.tobytes()


@pytest.mark.slow
@pytest.mark.parametrize("make", [grids.GridWorldEnv, operations.ElevatorEnv, games.RunningGame])
def test_observations_in_parts_are_proven_equal(make: Callable[[], gym.Env]) -> None:
    env = make()
    ordinary = OrdinaryEnv(env)
    stepper = Stepper(ordinary.compiled, ordinary.parameters, np.random.PCG64(9))
    assert stepper.reset() == 0
    twin = ClassTwin(env, ordinary.record, ordinary.compiled.observation)
    numbers = twin.reset(np.random.Generator(np.random.PCG64(9)))
    assert stepper.observation.tobytes() == numbers["observation"].tobytes()
    assert stepper.state.tobytes() == numbers["state"].tobytes()


def test_many_seeds_share_one_compilation() -> None:
    shared: dict[str, Any] = {"episodes": 20, "max_episode_steps": 50}
    many = qtab.train_many(grids.CliffEnv, seeds=[1, 2, 3], backend="numba", **shared)
    for i, seed in enumerate((1, 2, 3)):
        single = qtab.train(grids.CliffEnv(), seed=seed, backend="gymnasium", **shared)
        assert many.episode_returns[i].tobytes() == single.episode_returns.tobytes()


def test_the_environment_object_is_not_stepped() -> None:
    env = grids.CliffEnv()
    before = copy.deepcopy(vars(env))
    qtab.train(env, episodes=3, max_episode_steps=20, backend="numba")
    assert {name: str(value) for name, value in before.items()} == {
        name: str(value) for name, value in vars(env).items()
    }


def test_a_failing_step_raises_the_users_error() -> None:
    with pytest.raises(ValueError, match=r"cell 3[12] does not exist") as caught:
        qtab.train(failing.Breaks(), episodes=200, backend="numba", max_episode_steps=100, seed=1)
    files = [entry.path.name for entry in caught.traceback]  # type: ignore[union-attr]
    assert "failing.py" in files


def test_an_index_out_of_bounds_raises_pythons_error() -> None:
    with pytest.raises(IndexError, match=r"index 1[2-9] is out of bounds"):
        qtab.train(failing.LeavesArray(), episodes=200, backend="numba", max_episode_steps=100, seed=1)


def test_integers_that_leave_64_bits_are_found_before_training() -> None:
    with pytest.raises(ValueError, match=r"failing\.py.*'an error' in compiled code.*integers beyond 64 bits"):
        qtab.train(failing.BigIntegers(), episodes=10, backend="numba")


def test_different_numbers_are_found_before_training(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("qtab.compilation.checks.code_checks.INTEGER_OPERATIONS", {})
    monkeypatch.setattr("qtab.compilation.cache.code_files._folders", lambda _: iter([]))
    monkeypatch.setattr("qtab.compilation.ordinary._store", Store())
    with pytest.raises(ValueError, match=r"failing\.py.*self\.cell is .* in compiled code and .* in Python"):
        qtab.train(failing.BigIntegers(), episodes=10, backend="numba")


def test_attributes_that_outlive_episodes_are_refused() -> None:
    with pytest.raises(ValueError, match=r"games\.py:\d+: self.episodes keeps its value.*assign self.episodes"):
        qtab.train(games.GamblerEnv(), episodes=10, backend="numba")


def test_a_refusal_names_the_users_line() -> None:
    from support.environments.gym_classes import refused

    with pytest.raises(ValueError, match=r"refused\.py:\d+: np\.exp rounds differently.*write math\.exp for np\.exp"):
        qtab.train(refused.NumpyExp(), episodes=10, backend="numba")


class LocalMaskEnv(grids.CliffEnv):
    """Has action masks that depend on a local variable."""

    def reset(self, *, seed=None, options=None):
        observation, _ = super().reset(seed=seed)
        return observation, {"action_mask": np.ones(4, dtype=np.int8)}

    def step(self, action):
        observation, reward, terminated, truncated, _ = super().step(action)
        mask = np.ones(4, dtype=np.int8)
        return observation, reward, terminated, truncated, {"action_mask": mask}


class FloatMaskEnv(grids.CliffEnv):
    """Its action masks are floats, as in Python stepping they must not be."""

    def action_masks(self):
        return np.ones(4)


def test_masks_that_cannot_be_compiled_are_refused_with_their_line_if_the_run_needs_them() -> None:
    pattern = (
        r"backend='numba' asks: .*test_ordinary_classes\.py:\d+: the action mask.*write a method action_masks\(self\)"
    )
    with pytest.raises(ValueError, match=pattern):
        qtab.train(LocalMaskEnv(), episodes=3, backend="numba", action_mask=True)
    qtab.train(LocalMaskEnv(), episodes=3, max_episode_steps=20, backend="numba")
    pattern = r"test_ordinary_classes\.py:\d+: the action mask is an array of float64 .*; return an array of 4 booleans"
    with pytest.raises(ValueError, match=pattern):
        qtab.train(FloatMaskEnv(), episodes=3, backend="numba", action_mask=True)


def test_a_changed_attribute_changes_the_compiled_code() -> None:
    env = grids.CliffEnv(wind=0.0)
    shared: dict[str, Any] = {"episodes": 20, "max_episode_steps": 50, "seed": 2}
    calm = qtab.train(env, backend="numba", **shared)
    env.wind = 0.5
    windy = qtab.train(env, backend="numba", **shared)
    assert windy.tables.tobytes() == qtab.train(env, backend="gymnasium", **shared).tables.tobytes()
    assert not np.array_equal(calm.tables, windy.tables)


STRIDE = 2


def reward_of(cell: Any) -> Any:
    return float(cell)


def other_reward_of(cell: Any) -> Any:
    return -float(cell)


class ConstantsEnv(gym.Env):
    """Reads constants from an attribute, the class and the module, and calls a function of the module."""

    STRIDES = (0, 1)
    observation_space = gym.spaces.Discrete(1000)
    action_space = gym.spaces.Discrete(2)

    def __init__(self) -> None:
        self.offset = 1

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        return self.cell, {}

    def step(self, action):
        self.cell += self.STRIDES[action] * STRIDE + self.offset
        return self.cell, reward_of(self.cell), self.cell >= 50, False, {}


@pytest.mark.parametrize("changed", ["attribute", "class attribute", "global variable", "global function"])
def test_a_changed_constant_is_compiled_again(changed: str, monkeypatch: pytest.MonkeyPatch) -> None:
    env = ConstantsEnv()
    before = OrdinaryEnv(env).compiled
    assert OrdinaryEnv(env).compiled is before
    if changed == "attribute":
        env.offset = 3
    elif changed == "class attribute":
        monkeypatch.setattr(ConstantsEnv, "STRIDES", (1, 2))
    elif changed == "global variable":
        monkeypatch.setitem(globals(), "STRIDE", 5)
    else:
        monkeypatch.setitem(globals(), "reward_of", other_reward_of)
    after = OrdinaryEnv(env)
    assert after.compiled is not before
    stepper = Stepper(after.compiled, after.parameters, np.random.PCG64(0))
    twin = ClassTwin(env, after.record, after.compiled.observation)
    twin.reset(np.random.default_rng(0))
    assert stepper.reset() >= 0
    for action in (1, 0, 1):
        assert stepper.step(action) >= 0
        numbers = twin.step(action, np.random.default_rng(0))
        assert stepper.reward[0] == numbers["reward"]
        assert stepper.state.tobytes() == numbers["state"].tobytes()
