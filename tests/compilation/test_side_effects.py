"""Environments whose methods may have effects outside of them are refused before anything of them is run."""

import inspect
import logging
import os
import random
import socket
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.twins.class_twin import restored, twin_of
from qtab.compilation.twins.side_effects import refuse_effects

RAN: list[str] = []
"""What the methods of the classes below have run; a class that is refused leaves it as it is."""
BOARD = [0, 0, 0]
SCORES = {"steps": 0}
COUNT = 0
LOGGER = logging.getLogger("test_side_effects")
OUTPUT: Any = sys.__stdout__
LOCK = threading.Lock()


class Quiet(gym.Env):
    """A walk without effects, which is compiled."""

    observation_space = gym.spaces.Discrete(10)
    action_space = gym.spaces.Discrete(2)
    shared = np.zeros(3)

    def __init__(self) -> None:
        self.window: Any = None
        self.output = OUTPUT
        self.render_mode = None

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        self.effect()
        return self.cell, {}

    def step(self, action):
        self.cell = min(max(self.cell + 2 * int(action) - 1, 0), 9)
        return self.cell, float(self.cell == 9), self.cell == 9, False, {}

    def effect(self):
        pass


class Window:
    def update(self):
        RAN.append("window")

    def pop(self):
        RAN.append("window")


class Prints(Quiet):
    def effect(self):
        print("reset")  # noqa: T201 # here


class OpensFile(Quiet):
    def effect(self):
        open("effect.txt", "w")  # noqa: SIM115, PTH123 # here


class WritesFile(Quiet):
    def effect(self):
        self.output.write("reset")  # here


class WritesPath(Quiet):
    def effect(self):
        Path("effect.txt").write_text("reset")  # here


class Connects(Quiet):
    def effect(self):
        socket.create_connection(("localhost", 9))  # here


class StartsProcess(Quiet):
    def effect(self):
        subprocess.run([sys.executable, "-c", ""], check=False)  # here


class Logs(Quiet):
    def effect(self):
        LOGGER.info("reset")  # here


class Warns(Quiet):
    def effect(self):
        warnings.warn("reset", stacklevel=2)  # here


class ReadsClock(Quiet):
    def effect(self):
        self.began = time.monotonic()  # here


class Sleeps(Quiet):
    def effect(self):
        time.sleep(0.0)  # here


class DrawsGlobally(Quiet):
    def effect(self):
        self.cell = int(np.random.randint(3))  # noqa: NPY002 # here


class DrawsInModule(Quiet):
    def effect(self):
        self.cell = random.randrange(3)  # noqa: S311 # here


class ChangesEnvironmentVariables(Quiet):
    def effect(self):
        os.environ["QTAB_EFFECT"] = "1"  # here


class CountsInModule(Quiet):
    def effect(self):
        global COUNT  # here
        COUNT += 1


class CountsInDict(Quiet):
    def effect(self):
        SCORES["steps"] += 1  # here


class CountsInClass(Quiet):
    count = 0

    def effect(self):
        CountsInClass.count += 1  # here


class CountsInItsClass(Quiet):
    count = 0

    def effect(self):
        type(self).count += 1  # here


class AppendsToModule(Quiet):
    def effect(self):
        RAN.append("reset")


class AppendsThroughVariable(Quiet):
    def effect(self):
        found = RAN
        found.append("reset")


class ChangesBoard(Quiet):
    def effect(self):
        board = BOARD
        board[1] += 1


class ChangesArrayOfClass(Quiet):
    def effect(self):
        self.shared[0] += 1.0


class UpdatesWindow(Quiet):
    def __init__(self) -> None:
        super().__init__()
        self.window = Window()

    def effect(self):
        if self.window is not None:  # here
            self.window.update()


class UpdatesWindowOfVariable(UpdatesWindow):
    def effect(self):
        window = self.window  # here
        window.pop()


class UpdatesWindowOfModule(Quiet):
    opened = Window()

    def effect(self):
        self.opened.update()  # here


class MakesWindow(Quiet):
    def effect(self):
        Window().update()  # here


class PassesItself(Quiet):
    def effect(self):
        changed(self)  # here


def changed(env: Any) -> None:
    env.window.update()


class Locks(Quiet):
    def effect(self):
        with LOCK:  # here
            self.cell = 0


class Saves(Quiet):
    def effect(self):
        np.save("effect.npy", np.zeros(1))  # here


class SavesArray(Quiet):
    def effect(self):
        np.zeros(1).tofile("effect.bin")  # here


class Samples(Quiet):
    def effect(self):
        self.cell = int(self.observation_space.sample()) % 3  # here


class Imports(Quiet):
    def effect(self):
        import this  # noqa: F401 # here


class Evaluates(Quiet):
    def effect(self):
        eval("print(1)")  # noqa: S307 # here


class CallsAttribute(Quiet):
    def __init__(self) -> None:
        super().__init__()
        self.call = lambda: RAN.append("called")

    def effect(self):
        self.call()


class SortsByFunction(Quiet):
    def effect(self):
        self.cell = len(list(map(print, [1])))  # here


class PropertyPrints(Quiet):
    @property
    def loud(self):
        print("read")  # noqa: T201 # here
        return 0

    def effect(self):
        self.cell = self.loud


class StepPrints(Quiet):
    def step(self, action):
        print("step")  # noqa: T201 # here
        return super().step(action)


class MaskPrints(Quiet):
    def action_masks(self):
        print("mask")  # noqa: T201 # here
        return np.ones(2)


REFUSED = [one for one in Quiet.__subclasses__() if one is not UpdatesWindow] + [UpdatesWindowOfVariable, UpdatesWindow]
CHANGING_DATA = (AppendsToModule, AppendsThroughVariable, ChangesBoard, ChangesArrayOfClass)
"""Classes of which a copy changes lists and arrays, which are restored."""


def line_of(cls: type) -> int:
    """The line of a class that is marked with ``# here``."""
    lines, first = inspect.getsourcelines(cls)
    return first + next(number for number, line in enumerate(lines) if line.rstrip().endswith("# here"))


@pytest.mark.parametrize("cls", [one for one in REFUSED if one not in CHANGING_DATA], ids=lambda one: one.__name__)
def test_effects_are_refused_and_never_happen(
    cls: Callable[[], gym.Env], capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    env, numpy_state = cls(), repr(np.random.get_state())  # noqa: NPY002
    with pytest.raises(NotCompilable) as caught:
        refuse_effects(env)
    if cls is not CallsAttribute:
        assert (caught.value.file, caught.value.line) == (__file__, line_of(cls))  # type: ignore[arg-type]
    assert caught.value.advice
    assert not RAN
    assert COUNT == SCORES["steps"] == CountsInClass.count == CountsInItsClass.count == 0
    assert repr(np.random.get_state()) == numpy_state  # noqa: NPY002
    assert capsys.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())
    assert "QTAB_EFFECT" not in os.environ


@pytest.mark.parametrize("cls", CHANGING_DATA, ids=lambda one: one.__name__)
def test_data_outside_of_the_environment_is_restored(cls: Callable[[], gym.Env]) -> None:
    env = cls()
    shared = refuse_effects(env)
    with pytest.raises(NotCompilable, match="outside of the environment is changed"), restored(shared):
        twin_of(env).reset(seed=0)
    assert (RAN, BOARD, Quiet.shared.tolist()) == ([], [0, 0, 0], [0.0, 0.0, 0.0])


def test_a_class_without_effects_is_not_refused() -> None:
    env = Quiet()
    refuse_effects(env)
    twin = twin_of(env)
    twin.reset(seed=0)
    assert "cell" not in vars(env)
    assert twin.output is OUTPUT


class Drawn(Quiet):
    """Draws if a window is wanted."""

    def __init__(self, render_mode: str | None = None) -> None:
        super().__init__()
        self.render_mode = render_mode

    def effect(self):
        if self.render_mode == "human" or (self.window is not None and not self.render_mode):
            print("drawn")  # noqa: T201


def test_branches_that_attributes_exclude_are_not_searched() -> None:
    refuse_effects(Drawn())
    with pytest.raises(NotCompilable, match="print is called"):
        refuse_effects(Drawn("human"))


class Deleted(Quiet):
    """Closes something when it is deleted, which would happen for a copy, too."""

    def __del__(self) -> None:
        RAN.append("deleted")


def test_a_class_that_closes_when_it_is_deleted_is_refused() -> None:
    env = Deleted()
    with pytest.raises(NotCompilable, match="Deleted defines __del__"):
        refuse_effects(env)
    assert not RAN
    del env
    RAN.clear()


class Pickled(gym.utils.EzPickle, Quiet):
    """Is made again by its constructor when it is copied as Gymnasium's EzPickle does."""

    def __init__(self, first: int = 0) -> None:
        gym.utils.EzPickle.__init__(self, first)
        Quiet.__init__(self)
        RAN.append("made")
        self.first = first

    def effect(self):
        self.cell = self.first


def test_copies_are_made_without_the_constructor_and_keep_changed_attributes() -> None:
    env = Pickled()
    RAN.clear()
    env.first = 4
    refuse_effects(env)
    twin = twin_of(env)
    assert twin.reset(seed=0)[0] == 4
    assert not RAN


def test_training_steps_such_a_class_in_python_and_names_the_line(
    caplog: pytest.LogCaptureFixture, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("qtab.training.setup.ordinary_class.LEAST_STEPS", 1)
    run = qtab.train(StepPrints(), episodes=2, max_episode_steps=10, seed=0, progress=False)
    assert run.config.backend == "gymnasium"
    assert capsys.readouterr().out.count("step") == run.episode_lengths.sum()
    qtab.train(StepPrints(), episodes=2, max_episode_steps=10, seed=0)
    assert f"{__file__}:{line_of(StepPrints)}: print is called; log in a wrapper or a callback" in caplog.text
