"""Under the backend "auto" an ordinary class is compiled where it can be, with the bytes of Python."""

import builtins
import logging
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.training.setup import ordinary_class
from qtab.training.setup.expected_steps import most_steps
from support.environments.gym_classes import control, games, grids

pytest.importorskip("numba")
# As in a program: where warnings are errors, no class is compiled by default.
pytestmark = pytest.mark.filterwarnings("default")

SHORT: dict[str, Any] = {"episodes": 40, "max_episode_steps": 50, "seed": 4, "progress": False}
Register = Callable[..., str]


@pytest.fixture(autouse=True)
def _files_of_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.fixture
def compiles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compiles for short runs, too."""
    monkeypatch.setattr(ordinary_class, "LEAST_STEPS", 1)


@pytest.fixture
def register() -> Iterator[Register]:
    """Registers a class, or a function that makes an environment, and returns the id."""
    ids: list[str] = []

    def register(cls: Any, **arguments: Any) -> str:
        ids.append(f"Auto{cls.__name__.strip('<>')}{len(ids)}-v0")
        gym.register(ids[-1], cls, **arguments)
        return ids[-1]

    yield register
    for one in ids:
        gym.registry.pop(one, None)


def assert_equal(one: Any, other: Any) -> None:
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    assert one.episode_lengths.tobytes() == other.episode_lengths.tobytes()
    assert one.terminated.tobytes() == other.terminated.tobytes()
    assert one.tables.tobytes() == other.tables.tobytes()


def test_a_long_run_is_compiled_and_a_short_one_is_not(
    register: Register, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ordinary_class, "LEAST_STEPS", 10_000)
    env = register(grids.CliffEnv)
    settings: dict[str, Any] = {"max_episode_steps": 100, "seed": 3}
    long = qtab.train(env, episodes=120, **settings)
    assert long.config.backend == "numba"
    assert_equal(long, qtab.train(env, episodes=120, backend="python", **settings))
    assert "stepped in Python" not in caplog.text
    short = qtab.train(env, episodes=99, **settings)
    assert short.config.backend == "gymnasium"
    assert "CliffEnv, and it is compiled only for runs of about 10,000 steps or more" in caplog.text


def test_a_run_of_short_episodes_is_stepped_in_python(
    register: Register, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ordinary_class, "LEAST_STEPS", 10_000)
    monkeypatch.setattr("qtab.compilation.ordinary.OrdinaryEnv._compiled", pytest.fail)
    run = qtab.train(register(grids.MazeEnv, max_episode_steps=1_000), episodes=20, seed=3)
    assert run.config.backend == "gymnasium"
    assert "it is compiled only for runs of about 10,000 steps or more" in caplog.text


def test_the_most_steps_of_a_run() -> None:
    env = gym.wrappers.TimeLimit(grids.CliffEnv(), 30)
    config = qtab.Config(episodes=7)
    assert most_steps(env, config) == 7 * 30
    assert most_steps(env, config.replace(max_episode_steps=20)) == 7 * 20
    assert most_steps(grids.CliffEnv(), config) == 7 * 1_000


CLASSES: dict[str, tuple[Any, dict[str, Any]]] = {
    "grid": (grids.GridWorldEnv, {"discretizer": "identity"}),
    "maze": (grids.MazeEnv, {}),
    "keys": (grids.KeyDoorEnv, {}),
    "masks": (grids.MaskedGridEnv, {"action_mask": True}),
    "thermostat": (control.ThermostatEnv, {"discretizer": "bins", "bins": 12}),
    "pendulum": (control.PendulumEnv, {"discretizer": "bins", "bins": 5}),
    "dice": (games.DiceEnv, {}),
    "bandit": (games.BanditEnv, {}),
    "subclass": (games.RunningGame, {}),
}


@pytest.mark.slow
@pytest.mark.usefixtures("compiles")
@pytest.mark.parametrize("name", CLASSES)
def test_classes_have_the_bytes_of_python(name: str, register: Register) -> None:
    cls, settings = CLASSES[name]
    env = register(cls, max_episode_steps=60)
    settings = {**SHORT, "max_episode_steps": None, **settings}
    run = qtab.train(env, **settings)
    assert run.config.backend == "numba"
    assert_equal(run, qtab.train(env, backend="python", **settings))


@pytest.mark.usefixtures("compiles")
@pytest.mark.parametrize("backend", ["python", "gymnasium"])
def test_the_backend_python_never_compiles(backend: Any, register: Register, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("qtab.compilation.ordinary.OrdinaryEnv.__init__", pytest.fail)
    assert qtab.train(register(grids.CliffEnv), backend=backend, **SHORT).config.backend == "gymnasium"


def test_many_runs_count_together(register: Register, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ordinary_class, "LEAST_STEPS", 3 * 40 * 50)
    settings = {name: value for name, value in SHORT.items() if name != "seed"}
    env = register(grids.CliffEnv)
    for made in (grids.CliffEnv, env):
        many = qtab.train_many(made, seeds=3, threads=2, tables=True, **settings)
        assert many.config.backend == "numba"
        for seed in range(3):
            single = qtab.train(env, **{**SHORT, "seed": seed})
            assert single.config.backend == "gymnasium"
            assert many.episode_returns[seed].tobytes() == single.episode_returns.tobytes()
            assert many.tables[seed].tobytes() == single.tables.tobytes()  # type: ignore[index]


def test_a_store_of_a_sweep_is_continued_whether_or_not_the_class_is_compiled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ordinary_class, "LEAST_STEPS", 3 * 40 * 50)
    settings = {name: value for name, value in SHORT.items() if name != "seed"}
    store, grid = tmp_path / "sweep.db", {"epsilon": [0.1, 0.2]}
    few = qtab.sweep(grids.CliffEnv, grid, seeds=2, threads=1, store=store, **settings)
    monkeypatch.setattr("qtab.sweeps.executors.ExecutorTraining.__init__", pytest.fail)  # of processes
    more = qtab.sweep(grids.CliffEnv, grid, seeds=4, threads=1, store=store, **settings)
    assert (len(few), len(more)) == (4, 8)
    monkeypatch.undo()
    assert [config["backend"] for config in more.configs] == ["gymnasium"] * 2
    in_python = qtab.sweep(grids.CliffEnv, grid, seeds=4, threads=1, backend="python", **settings)
    assert str(in_python) == str(more)


@pytest.mark.usefixtures("compiles")
class TestWithoutNumba:
    """Python steps the class, with the reason in one line."""

    def check(self, env: str, caplog: pytest.LogCaptureFixture, reason: str) -> None:
        run = qtab.train(env, **{**SHORT, "progress": None})
        assert run.config.backend == "gymnasium"
        assert caplog.text.count("stepped in Python") == 1
        assert reason in caplog.text

    def test_not_installed(
        self, register: Register, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setitem(sys.modules, "numba", None)
        self.check(
            register(grids.CliffEnv), caplog, "with Numba (pip install 'qtab[numba]'), such a class can be compiled"
        )

    def test_too_old(
        self, register: Register, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("qtab.compilation.functional.numba_version", lambda: "0.58.1")
        self.check(register(grids.MazeEnv), caplog, "Numba 0.58.1 is too old; pip install 'qtab[numba]'")

    def test_broken(
        self, register: Register, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        loaded = builtins.__import__

        def broken(name: str, *arguments: Any, **named: Any) -> Any:
            if name.partition(".")[0] in ("numba", "llvmlite"):
                raise SystemError("Numba needs another NumPy")
            return loaded(name, *arguments, **named)

        monkeypatch.setattr("qtab.compilation.cache.digest._environment", lambda: broken("llvmlite"))
        reason = "it could not be compiled: SystemError: Numba needs another NumPy"
        self.check(register(grids.KeyDoorEnv), caplog, reason)

    def test_disabled(
        self, register: Register, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
        self.check(register(games.DiceEnv), caplog, "NUMBA_DISABLE_JIT is set")


@pytest.mark.usefixtures("compiles")
def test_a_run_of_an_id_can_be_used_like_others(register: Register) -> None:
    env = register(grids.CliffEnv, max_episode_steps=30)
    settings = {**SHORT, "max_episode_steps": None}
    run = qtab.train(env, **settings)
    in_python = qtab.train(env, backend="python", **settings)
    assert run.config.backend == "numba"
    assert qtab.verify(run).equal
    assert_equal(qtab.train(config=run.config), run)
    assert len(qtab.explain(run, episode=3, steps=5)) == 5
    assert qtab.diagnose(run) is not None
    assert qtab.evaluate(run, 30).returns.tobytes() == qtab.evaluate(in_python, 30).returns.tobytes()
    recorded = qtab.train(env, record=3, visits=True, snapshots=2, **settings)
    again = qtab.train(env, record=3, visits=True, snapshots=2, backend="python", **settings)
    assert_equal(recorded, again)
    assert recorded.visits.tobytes() == again.visits.tobytes()  # type: ignore[union-attr]
    for one, other in zip(recorded.recordings, again.recordings, strict=True):
        assert one.actions == other.actions


@pytest.mark.usefixtures("compiles")
def test_callbacks_of_the_package_do_not_prevent_a_compilation(register: Register, tmp_path: Path) -> None:
    callbacks = qtab.callbacks
    evaluate = callbacks.EvaluateEvery(3, every=20)
    logger = callbacks.CSVLogger(tmp_path / "log.csv", every=10, evaluation=evaluate)
    chosen = [evaluate, logger, callbacks.Checkpoint(tmp_path / "run.npz", every=20), callbacks.StopAtReturn(1e9)]
    env = register(grids.CliffEnv, max_episode_steps=30)
    run = qtab.train(env, callback=chosen, **SHORT)
    assert run.config.backend == "numba"
    returns = [one.returns.tobytes() for one in evaluate.evaluations]
    assert_equal(run, qtab.train(env, callback=chosen, backend="python", **SHORT))
    assert returns == [one.returns.tobytes() for one in evaluate.evaluations]


@pytest.mark.usefixtures("compiles")
def test_a_refusal_names_line_construct_and_advice(register: Register, caplog: pytest.LogCaptureFixture) -> None:
    from support.environments.gym_classes import refused

    caplog.set_level(logging.WARNING, "qtab")
    env = register(refused.NumpyExp)
    qtab.train(env, **{**SHORT, "progress": None, "discretizer": "bins", "bins": 4})
    found = [
        record.message for record in caplog.records if "NumpyExp" in record.message and "refused.py" in record.message
    ]
    assert len(found) == 1
    assert "np.exp rounds differently in compiled code" in found[0]
    assert found[0].endswith("write math.exp for np.exp")
