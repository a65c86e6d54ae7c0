"""Under the backend "auto" an ordinary class is compiled where it can be, with the bytes of Python."""

import builtins
import logging
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.training.setup import ordinary_class
from qtab.training.setup.ordinary_class import LEAST_STEPS, counted_steps
from support.gym_classes import games, grids

pytest.importorskip("numba")

SHORT: dict[str, Any] = {"episodes": 40, "max_episode_steps": 50, "seed": 4, "progress": False}


@pytest.fixture(autouse=True)
def _files_of_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.fixture
def compiles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compiles for short runs, too."""
    monkeypatch.setattr(ordinary_class, "LEAST_STEPS", 1)


def assert_equal(one: Any, other: Any) -> None:
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    assert one.episode_lengths.tobytes() == other.episode_lengths.tobytes()
    assert one.tables.tobytes() == other.tables.tobytes()


def test_a_long_run_is_compiled_and_a_short_one_is_not(caplog: pytest.LogCaptureFixture) -> None:
    settings: dict[str, Any] = {"max_episode_steps": 100, "seed": 3}
    long = qtab.train(grids.CliffEnv(), episodes=LEAST_STEPS // 100, **settings)
    assert long.config.backend == "numba"
    assert_equal(long, qtab.train(grids.CliffEnv(), episodes=LEAST_STEPS // 100, backend="python", **settings))
    assert "stepped in Python" not in caplog.text
    short = qtab.train(grids.CliffEnv(), episodes=LEAST_STEPS // 100 - 1, **settings)
    assert short.config.backend == "gymnasium"
    assert "CliffEnv, and it is compiled only for runs that may take 100,000 steps or more" in caplog.text


def test_the_counted_steps_of_a_run() -> None:
    env = gym.wrappers.TimeLimit(grids.CliffEnv(), 30)
    config = qtab.Config(episodes=7)
    assert counted_steps(env, config) == 7 * 30
    assert counted_steps(env, config.replace(max_episode_steps=20)) == 7 * 20
    assert counted_steps(grids.CliffEnv(), config) == 7 * 1_000


@pytest.mark.usefixtures("compiles")
@pytest.mark.parametrize("backend", ["python", "gymnasium"])
def test_the_backend_python_never_compiles(backend: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("qtab.compilation.ordinary.OrdinaryEnv.__init__", pytest.fail)
    env = grids.CliffEnv()
    assert qtab.train(env, backend=backend, **SHORT).config.backend == "gymnasium"
    assert env.position is not None


def test_many_runs_count_together(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ordinary_class, "LEAST_STEPS", 3 * 40 * 50)
    settings = {name: value for name, value in SHORT.items() if name != "seed"}
    many = qtab.train_many(grids.CliffEnv, seeds=3, threads=2, tables=True, **settings)
    assert many.config.backend == "numba"
    for seed in range(3):
        single = qtab.train(grids.CliffEnv(), **{**SHORT, "seed": seed})
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

    def check(self, caplog: pytest.LogCaptureFixture, reason: str) -> None:
        run = qtab.train(grids.CliffEnv(), **{**SHORT, "progress": None})
        assert run.config.backend == "gymnasium"
        assert caplog.text.count("stepped in Python") == 1
        assert reason in caplog.text

    def test_not_installed(self, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setitem(sys.modules, "numba", None)
        self.check(caplog, "with Numba (pip install 'qtab[numba]'), such a class can be compiled")

    def test_too_old(self, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("qtab.compilation.functional.numba_version", lambda: "0.58.1")
        self.check(caplog, "Numba 0.58.1 is too old; pip install 'qtab[numba]'")

    def test_broken(self, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
        loaded = builtins.__import__

        def broken(name: str, *arguments: Any, **named: Any) -> Any:
            if name.partition(".")[0] in ("numba", "llvmlite"):
                raise SystemError("Numba needs another NumPy")
            return loaded(name, *arguments, **named)

        monkeypatch.setattr("qtab.compilation.cache.digest._environment", lambda: broken("llvmlite"))
        self.check(caplog, "it could not be compiled: SystemError: Numba needs another NumPy")

    def test_disabled(self, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
        self.check(caplog, "NUMBA_DISABLE_JIT is set")


@pytest.mark.usefixtures("compiles")
def test_attributes_that_outlive_an_episode_are_kept_in_python(caplog: pytest.LogCaptureFixture) -> None:
    env = games.GamblerEnv()
    run = qtab.train(env, **{**SHORT, "progress": None})
    assert run.config.backend == "gymnasium"
    assert env.episodes == len(run.episode_returns)
    assert "self.episodes keeps its value from one episode to the next; assign self.episodes in reset" in caplog.text


@pytest.mark.usefixtures("compiles")
def test_the_object_is_left_as_it_is_and_changed_attributes_are_used() -> None:
    env, plain = grids.CliffEnv(), grids.CliffEnv()
    env.wind = plain.wind = 0.7
    before = dict(vars(env))
    run = qtab.train(env, **SHORT)
    assert run.config.backend == "numba"
    assert vars(env) == before
    assert_equal(run, qtab.train(plain, backend="python", **SHORT))
    assert plain.np_random is not None


@pytest.mark.usefixtures("compiles")
def test_wrappers_are_as_for_functional_environments(caplog: pytest.LogCaptureFixture) -> None:
    limited = qtab.train(gym.wrappers.TimeLimit(gym.wrappers.OrderEnforcing(grids.CliffEnv()), 25), **SHORT)
    assert limited.config.backend == "numba"
    assert limited.episode_lengths.max() == 25
    wrapped = qtab.train(gym.wrappers.RecordEpisodeStatistics(grids.CliffEnv()), **{**SHORT, "progress": None})
    assert wrapped.config.backend == "gymnasium"
    assert "does not implement its wrapper RecordEpisodeStatistics" in caplog.text


@pytest.mark.usefixtures("compiles")
def test_a_registered_id() -> None:
    gym.register("AutoCliff-v0", lambda **_: grids.CliffEnv(), max_episode_steps=30)
    try:
        run = qtab.train("AutoCliff-v0", **{**SHORT, "max_episode_steps": None})
        assert run.config.backend == "numba"
        assert_equal(run, qtab.train("AutoCliff-v0", **{**SHORT, "max_episode_steps": None, "backend": "python"}))
        assert qtab.verify(run).equal
        assert_equal(qtab.train(config=run.config), run)
        assert len(qtab.explain(run, episode=3, steps=5)) == 5
        assert qtab.diagnose(run) is not None
    finally:
        gym.registry.pop("AutoCliff-v0", None)


@pytest.mark.usefixtures("compiles")
def test_functions_of_masks_and_observations_read_the_environment_in_python(caplog: pytest.LogCaptureFixture) -> None:
    env = grids.MaskedGridEnv()
    settings = {**SHORT, "progress": None}
    run = qtab.train(env, action_mask=lambda _: env._mask(), **settings)
    assert run.config.backend == "gymnasium"
    assert "a function as action_mask may read the environment" in caplog.text
    compiled = qtab.train(grids.MaskedGridEnv(), action_mask=True, **settings)
    assert compiled.config.backend == "numba"
    assert_equal(run, compiled)


@pytest.mark.usefixtures("compiles")
def test_a_render_mode_is_shown_in_python() -> None:
    env = grids.GridWorldEnv()
    env.render_mode = "rgb_array"
    env._render_frame = lambda: None  # type: ignore[method-assign]
    assert qtab.train(env, **SHORT).config.backend == "gymnasium"


def test_runs_are_resumed_where_they_began(compiles: None, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(progress: qtab.Progress) -> bool:
        return progress.episodes < 20

    whole = qtab.train(grids.CliffEnv(), **SHORT)
    for backend in ("numba", "python"):
        part = qtab.train(grids.CliffEnv(), callback=stop, callback_every=10, backend=backend, **SHORT)
        resumed = qtab.resume(part, env=grids.CliffEnv())
        assert resumed.config.backend == part.config.backend == ("numba" if backend == "numba" else "gymnasium")
        assert_equal(resumed, whole)
        extended = qtab.resume(part, env=grids.CliffEnv(), episodes=60)
        assert extended.config.backend == part.config.backend
        again = qtab.train(grids.CliffEnv(), resume=part, **SHORT)
        assert_equal(again, whole)


@pytest.mark.usefixtures("compiles")
def test_a_stopped_episode_is_resumed_in_compiled_code() -> None:
    seen: list[Any] = []
    run = qtab.train(grids.CliffEnv(), callback=lambda progress: seen.append(progress.run), callback_every=15, **SHORT)
    for part in seen[:2]:
        assert_equal(qtab.resume(part, env=grids.CliffEnv()), run)


@pytest.mark.usefixtures("compiles")
def test_callbacks_get_no_environment() -> None:
    class Sees(qtab.callbacks.BaseCallback):
        env: Any = "unset"

        def on_start(self, config: qtab.Config, env: gym.Env | None) -> None:
            self.env = env

        def __call__(self, progress: qtab.Progress) -> None:
            pass

    compiled, python = Sees(), Sees()
    env = grids.CliffEnv()
    qtab.train(env, callback=compiled, **SHORT)
    qtab.train(env, callback=python, backend="python", **SHORT)
    assert compiled.env is None
    assert python.env is env


@pytest.mark.usefixtures("compiles")
def test_a_refusal_names_line_construct_and_advice(caplog: pytest.LogCaptureFixture) -> None:
    from support.gym_classes import refused

    caplog.set_level(logging.WARNING, "qtab")
    qtab.train(refused.NumpyExp(), **{**SHORT, "progress": None, "discretizer": "bins", "bins": 4})
    found = [
        record.message for record in caplog.records if "NumpyExp" in record.message and "refused.py" in record.message
    ]
    assert len(found) == 1
    assert "np.exp rounds differently in compiled code" in found[0]
    assert found[0].endswith("write math.exp for np.exp")
