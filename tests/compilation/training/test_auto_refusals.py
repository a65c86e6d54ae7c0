"""Where anything could differ from Python, the backend "auto" steps a class in Python, and gives the reason."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.training.setup import ordinary_class
from support.environments.gym_classes import seen_elsewhere, visible

pytest.importorskip("numba")
# As in a program: where warnings are errors, no class is compiled by default.
pytestmark = pytest.mark.filterwarnings("default")

SHORT: dict[str, Any] = {"episodes": 30, "max_episode_steps": 40, "seed": 4}
ID = "Visible-v0"


@pytest.fixture(autouse=True)
def _compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(ordinary_class, "LEAST_STEPS", 1)
    monkeypatch.setattr("qtab.training.setup.resolved_run._logged", set())
    yield
    gym.registry.pop(ID, None)
    visible.MADE.clear()
    visible.CLOSED.clear()


def train(cls: Any, **settings: Any) -> qtab.Run:
    """Trains in an environment made from an id."""
    gym.registry.pop(ID, None)
    gym.register(ID, cls)
    return qtab.train(ID, **{**SHORT, **settings})


def assert_equal(one: qtab.Run, other: qtab.Run) -> None:
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    assert one.tables.tobytes() == other.tables.tobytes()


REFUSED: dict[str, tuple[type[gym.Env], str]] = {
    "gymnasium's logger": (visible.Logs, "gymnasium.logger is called, whose messages compiled code leaves out"),
    "a property as space": (visible.ComputedSpace, "its observation_space is a property"),
    "a space replaced in reset": (visible.ReplacesSpace, "an object of type Discrete is made"),
    "a space changed in step": (visible.ChangesSpace, "`self.action_space.n` is assigned"),
    "close": (visible.Closes, "its method close may read"),
    "a reference kept by the constructor": (visible.Registers, "keeps a reference to the environment object"),
    "a reference in an attribute": (visible.Cycle, "keeps a reference to the environment object"),
    "a warning of NumPy": (visible.Overflows, "overflow encountered"),
    "a warning": (visible.Warns, "warn"),
    "a cache": (visible.Cached, "_bonus"),
    "__getattr__": (visible.Delegates, "Delegates defines __getattr__"),
    "a counter across episodes": (visible.Counts, "self.count keeps its value from one episode to the next"),
    "a second generator": (visible.SecondGenerator, "a second random generator"),
    "a generator that is replaced": (visible.ReplacesGenerator, "np_random"),
    "an info value that may raise an error": (seen_elsewhere.InfoDivides, "{'rate': 1 / (999 - self.cell)}"),
    "an info value that may not be set": (seen_elsewhere.InfoUnset, "this is left out in compiled code"),
    "an attribute for info that may raise an error": (seen_elsewhere.InfoAttribute, "`1.0 / (999 - self.cell)`"),
    "an info dict that others use": (seen_elsewhere.InfoShared, "an info dict is changed that other code may use"),
    "a reference to the attributes": (seen_elsewhere.KeepsAttributes, "keeps a reference to the environment object"),
    "a weak reference": (seen_elsewhere.KeepsWeakly, "keeps a reference to the environment object"),
    "close by super()": (seen_elsewhere.ClosesBySuper, "its method close may read all attributes"),
    "close and what only it reads": (seen_elsewhere.ClosesCounter, "its method close may read self.count"),
    "a space of the user": (seen_elsewhere.OwnSpace, "its space Counted is a class of your own"),
    "an attribute of the class": (visible.ChangesClass, "is assigned"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_class_with_something_that_shows_is_stepped_in_python(name: str, caplog: pytest.LogCaptureFixture) -> None:
    cls, reason = REFUSED[name]
    slip = visible.Plain.slip
    run = train(cls)
    assert run.config.backend == "gymnasium"
    assert caplog.text.count("stepped in Python") == 1
    assert reason in caplog.text
    assert_equal(run, train(cls, backend="python"))
    visible.Plain.slip = slip


def test_what_does_not_show_is_compiled() -> None:
    for cls in (visible.Plain, visible.ClosesWindow, seen_elsewhere.InfoNumbers):
        run = train(cls)
        assert run.config.backend == "numba"
        assert_equal(run, train(cls, backend="python"))


def test_an_object_is_stepped_in_python_and_is_afterwards_as_python_leaves_it(
    caplog: pytest.LogCaptureFixture,
) -> None:
    env, other = visible.Plain(), visible.Plain()
    run = qtab.train(env, **SHORT)
    assert run.config.backend == "gymnasium"
    assert "by default where qtab makes the environment from its id" in caplog.text
    assert "backend='numba' compiles" in caplog.text
    assert_equal(run, qtab.train(other, backend="python", **SHORT))
    assert env.cell == other.cell
    assert env.board.tobytes() == other.board.tobytes()
    assert env.np_random.bit_generator.state == other.np_random.bit_generator.state


def test_an_object_that_a_registered_function_hands_out_is_stepped_in_python(caplog: pytest.LogCaptureFixture) -> None:
    shared = visible.Plain()
    run = train(lambda **_: shared)
    assert run.config.backend == "gymnasium"
    assert "keeps a reference to the environment object" in caplog.text
    assert shared.np_random.bit_generator.state["state"]["state"] != np.random.PCG64(4).state["state"]["state"]
    assert train(lambda **_: visible.Plain()).config.backend == "numba"


def test_an_array_of_the_user_is_changed_as_in_python(caplog: pytest.LogCaptureFixture) -> None:
    board, other = np.zeros(10), np.zeros(10)
    assert train(lambda **_: visible.Plain(board)).config.backend == "gymnasium"
    assert "other code keeps a reference to self.board, which is changed in place" in caplog.text
    train(lambda **_: visible.Plain(other), backend="python")
    assert board.tobytes() == other.tobytes()
    assert board.any()
    assert train(visible.Plain, env_kwargs={"board": board}).config.backend == "gymnasium"
    assert "self.board is changed in place, and shares memory with self.spec" in caplog.text


class Changing(qtab.callbacks.BaseCallback):
    """Changes the class, as a curriculum does."""

    env: Any = "unset"

    def on_start(self, config: qtab.Config, env: gym.Env | None) -> None:
        self.env = env

    def __call__(self, progress: qtab.Progress) -> None:
        visible.Plain.slip = 0.02 * progress.episodes


def test_callbacks_of_the_user_are_called_in_python(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs, callback = [], Changing(every=5)
    for backend in ("auto", "python"):
        monkeypatch.setattr(visible.Plain, "slip", 0.1)
        runs.append(train(visible.Plain, callback=callback, backend=backend))
        assert isinstance(callback.env.unwrapped, visible.Plain)
    assert runs[0].config.backend == "gymnasium"
    assert "the callback Changing may read or change the environment" in caplog.text
    assert_equal(*runs)


def test_a_callback_of_the_user_is_called_in_python_when_a_run_is_resumed(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = []
    for backend in ("auto", "python"):
        monkeypatch.setattr(visible.Plain, "slip", 0.1)
        part = train(visible.Plain, callback=qtab.callbacks.StopAtReturn(-1e9, 10, every=10), backend=backend)
        assert len(part.episode_returns) == 10
        assert part.config.backend == ("numba" if backend == "auto" else "gymnasium")
        runs.append(qtab.resume(part, callback=Changing(every=5)))
    assert "is resumed in Python, which is much slower: the callback Changing may read" in caplog.text
    assert_equal(*runs)


def test_functions_and_evaluations_of_the_user_are_callbacks_too(caplog: pytest.LogCaptureFixture) -> None:
    def sees(_progress: qtab.Progress) -> None:
        pass

    own = qtab.callbacks.EvaluateEvery(2, every=10, env=gym.wrappers.TimeLimit(visible.Plain(), 40))
    replaced = qtab.callbacks.StopAtReturn(1e9)
    replaced.on_start = lambda *_: None  # type: ignore[method-assign]
    for callback in (sees, [own], [qtab.callbacks.StopAtReturn(1e9), replaced]):
        assert train(visible.Plain, callback=callback).config.backend == "gymnasium"
    assert "the callback test_functions" in caplog.text
    assert "the callback EvaluateEvery" in caplog.text


def test_functions_of_masks_and_discretizers_read_the_environment_in_python(caplog: pytest.LogCaptureFixture) -> None:
    masked = train(visible.Plain, action_mask=lambda _: np.ones(2, np.int8))
    assert masked.config.backend == "gymnasium"
    assert "a function as action_mask may read the environment" in caplog.text
    cells = train(visible.Plain, discretizer=lambda cell: (int(cell),), shape=(10,))
    assert cells.config.backend == "gymnasium"
    assert "a function as the discretizer" in caplog.text


def test_a_render_mode_is_shown_in_python() -> None:
    gym.register(ID, f"{visible.__name__}:Plain")
    run = qtab.train(ID, env_kwargs={"render_mode": "rgb_array"}, **SHORT)
    assert run.config.backend == "gymnasium"


def test_errors_for_warnings_and_of_numpy_are_raised_in_python(caplog: pytest.LogCaptureFixture) -> None:
    with np.errstate(over="raise"):
        assert train(visible.Plain).config.backend == "gymnasium"
    assert "np.seterr lets NumPy raise or report errors" in caplog.text
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert train(visible.Plain).config.backend == "gymnasium"
    assert "warnings are errors here" in caplog.text


def test_observations_of_the_wrong_type_raise_the_error_of_python(caplog: pytest.LogCaptureFixture) -> None:
    with pytest.raises((TypeError, ValueError)) as in_python:
        train(visible.FloatCells, backend="python")
    with pytest.raises(type(in_python.value)) as caught:
        train(visible.FloatCells)
    assert str(caught.value) == str(in_python.value)
    assert "the observation is a float, the space Discrete(10)" in caplog.text


def test_flags_that_are_no_booleans_raise_the_error_of_python() -> None:
    with pytest.raises(TypeError) as in_python:
        train(visible.IntegerFlags, backend="python")
    with pytest.raises(TypeError) as caught:
        train(visible.IntegerFlags)
    assert str(caught.value) == str(in_python.value)


def test_wrappers_of_the_user_are_stepped_in_python(caplog: pytest.LogCaptureFixture) -> None:
    made = [
        lambda **_: gym.wrappers.RecordEpisodeStatistics(visible.Plain()),
        lambda **_: gym.wrappers.TransformReward(visible.Plain(), lambda reward: 2 * float(reward)),
    ]
    for one in made:
        run = train(one)
        assert run.config.backend == "gymnasium"
        assert_equal(run, train(one, backend="python"))
    assert "does not implement its wrapper RecordEpisodeStatistics" in caplog.text
    limited = train(lambda **_: gym.wrappers.TimeLimit(gym.wrappers.OrderEnforcing(visible.Plain()), 7))
    assert limited.config.backend == "numba"
    assert limited.episode_lengths.max() <= 7


def test_environments_that_differ_from_object_to_object_are_made_for_each_run(caplog: pytest.LogCaptureFixture) -> None:
    settings: dict[str, Any] = {name: value for name, value in SHORT.items() if name != "seed"}
    gym.register(ID, f"{visible.__name__}:RandomBoard")
    assert qtab.train_many(ID, seeds=2, threads=1, **settings).config.backend == "gymnasium"
    assert "each run makes an environment, which may differ: " in caplog.text


@pytest.mark.parametrize("cls", [seen_elsewhere.CountsObjects, seen_elsewhere.DrawsLater, seen_elsewhere.TakesLevels])
def test_a_constructor_with_effects_is_called_for_each_run(
    cls: Any, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings: dict[str, Any] = {name: value for name, value in SHORT.items() if name != "seed"}
    gym.register(ID, f"{cls.__module__}:{cls.__name__}")
    for made in (cls, ID, lambda: cls()):
        assert qtab.train_many(made, seeds=2, threads=1, **settings).config.backend == "gymnasium"
        assert "each run makes an environment, which may differ: " in caplog.text
        caplog.clear()
        monkeypatch.setattr("qtab.training.setup.resolved_run._logged", set())


def test_an_ordinary_constructor_is_compiled_for_many_runs() -> None:
    settings: dict[str, Any] = {name: value for name, value in SHORT.items() if name != "seed"}
    gym.register(ID, f"{visible.__name__}:Plain")
    for made in (visible.Plain, ID, seen_elsewhere.make_plain):
        assert qtab.train_many(made, seeds=2, threads=1, **settings).config.backend == "numba"


def test_a_function_that_keeps_the_objects_makes_them_for_each_run(caplog: pytest.LogCaptureFixture) -> None:
    settings: dict[str, Any] = {name: value for name, value in SHORT.items() if name != "seed"}
    many = qtab.train_many(visible.Registers, seeds=1, threads=1, **settings)
    assert many.config.backend == "gymnasium"
    assert "keeps a reference to the object" in caplog.text
