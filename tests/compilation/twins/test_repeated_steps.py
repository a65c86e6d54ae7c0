"""Steps that fail in compiled code only are taken in Python, and edited classes are compiled again."""

import linecache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.compilation.twins.repetition import Repetition

pytest.importorskip("numba")

SHORT: dict[str, Any] = {"episodes": 40, "max_episode_steps": 50, "seed": 4, "progress": False, "backend": "numba"}


@pytest.fixture(autouse=True)
def _files_of_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def assert_equal(one: Any, other: Any) -> None:
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    assert one.episode_lengths.tobytes() == other.episode_lengths.tobytes()
    assert one.tables.tobytes() == other.tables.tobytes()


class Large(gym.Env):
    """Its cell is computed with a product that needs more than 64 bits at one place, which random actions miss."""

    observation_space = gym.spaces.Discrete(200)
    action_space = gym.spaces.Discrete(2)

    def __init__(self, fails: bool = False, keeps: bool = False) -> None:
        self.fails, self.keeps = fails, keeps

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        self.product = 1
        self.total: float = 0
        return self.cell, {}

    def step(self, action):
        self.cell = self.cell + 1 if action == 1 else 0
        if self.np_random.random() < 0.5:
            self.total = self.total + 0.25
        if self.cell > 30:
            product = (self.cell + 2**40) * (2**40 + self.cell)
            if self.fails and self.cell == 36:
                raise ArithmeticError(f"a product of {product}")
            if self.keeps:
                self.product = product
            self.total = self.total + product % 3
        elif self.cell == 0:
            self.product = 1
        return self.cell, float(self.cell) + self.product % 7 + self.total, self.cell == 199, False, {}


LEARNING: dict[str, Any] = {
    **{"episodes": 60, "max_episode_steps": 300, "seed": 1, "epsilon": 0.02, "backend": "numba"},
    **{"initial_q": np.tile([0.0, 1000.0], (200, 1)), "progress": False},
}


@pytest.mark.parametrize("keeps", [False, True])
def test_a_step_that_fails_in_compiled_code_only_is_taken_in_python(
    keeps: bool, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("qtab.compilation.twins.repetition._logged", set())
    run = qtab.train(Large(keeps=keeps), **LEARNING)
    assert run.config.backend == "numba"
    assert caplog.text.count("an episode of Large goes on in Python") == 1
    assert_equal(run, qtab.train(Large(keeps=keeps), **{**LEARNING, "backend": "python"}))


def test_many_runs_and_evaluations_go_on_in_python() -> None:
    settings = {name: value for name, value in LEARNING.items() if name != "seed"}
    many = qtab.train_many(lambda: Large(keeps=True), seeds=3, threads=2, tables=True, **settings)
    assert many.config.backend == "numba"
    for seed in range(3):
        single = qtab.train(Large(keeps=True), **{**LEARNING, "seed": seed, "backend": "python"})
        assert many.tables[seed].tobytes() == single.tables.tobytes()  # type: ignore[index]
    run = qtab.train(Large(keeps=True), **LEARNING)
    evaluation = qtab.evaluate(run, 3, env=Large(keeps=True), seed=5)
    in_python = qtab.train(Large(keeps=True), **{**LEARNING, "backend": "python"})
    assert evaluation.returns.tobytes() == qtab.evaluate(in_python, 3, env=Large(keeps=True), seed=5).returns.tobytes()


def test_an_error_after_such_a_step_is_the_users() -> None:
    with pytest.raises(ArithmeticError, match="a product of 12089258196") as caught:
        qtab.train(Large(fails=True), **LEARNING)
    compiled: qtab.Run = caught.value.run  # type: ignore[attr-defined]
    with pytest.raises(ArithmeticError) as again:
        qtab.train(Large(fails=True), **{**LEARNING, "backend": "python"})
    assert_equal(compiled, again.value.run)  # type: ignore[attr-defined]


class Outside(Large):
    """Returns observations outside its space, which the bins clip."""

    observation_space = gym.spaces.Box(0.0, 20.0, (1,), np.float64)  # type: ignore[assignment]

    def reset(self, *, seed=None, options=None):
        cell, info = super().reset(seed=seed)
        return np.array([float(cell)]), info

    def step(self, action):
        cell, reward, terminated, _, _ = super().step(action)
        return np.array([float(cell)]), reward, terminated, False, {}


def test_observations_outside_the_space_are_those_of_python() -> None:
    settings = {**LEARNING, "discretizer": "bins", "bins": 10, "initial_q": np.tile([0.0, 1000.0], (10, 1))}
    run = qtab.train(Outside(), **settings)
    assert run.config.backend == "numba"
    assert_equal(run, qtab.train(Outside(), **{**settings, "backend": "python"}))


CELL = """
import gymnasium as gym

class Walk(gym.Env):
    observation_space = gym.spaces.Discrete(20)
    action_space = gym.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        return self.cell, {{}}

    def step(self, action):
        self.cell = min(self.cell + {stride} * int(action), 19)
        return self.cell, float(self.cell), self.cell == 19, False, {{}}
"""


def defined(text: str, name: str) -> Any:
    """The class that a cell of a notebook defines."""
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
    scope: dict[str, Any] = {"__name__": "__main__"}
    exec(compile(text, name, "exec"), scope)  # noqa: S102 - made here
    return scope["Walk"]


def test_a_class_that_is_edited_in_a_notebook_is_compiled_again() -> None:
    returns = []
    for stride in (1, 3):
        made = defined(CELL.format(stride=stride), f"<ipython-input-{stride}>")
        run = qtab.train(made(), **SHORT)
        assert run.config.backend == "numba"
        assert_equal(run, qtab.train(made(), **{**SHORT, "backend": "python"}))
        returns.append(run.episode_returns.tobytes())
    assert returns[0] != returns[1]


def test_python_stepping_of_a_vector_environment_is_logged_after_a_run_of_its_class(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("qtab.compilation.twins.repetition._logged", set())
    twin: Any = SimpleNamespace(env=Large())
    repetition = Repetition(twin, 0, "Large")
    for _ in range(2):
        repetition.log()
        repetition.log("a vector environment of %s is stepped in Python from now on")
    assert ["vector" in record.message for record in caplog.records] == [False, True]
