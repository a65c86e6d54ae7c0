"""Classes with effects outside of them; ``# here`` marks the line, and ``RAN`` has what was run."""

import logging
import os
import random
import socket
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

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
