"""The ``qtab`` command, in a process of its own as a user runs it, or in this one."""

import contextlib
import io
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

from qtab import train
from qtab.cli import main

QTAB = [sys.executable, "-m", "qtab"]

TOYS = '''
import time
import gymnasium as gym
import numpy as np


class Walk(gym.Env):
    """Five cells in a row; the right end is terminal."""

    observation_space = gym.spaces.Box(0.0, 4.0, (1,), np.float32)
    action_space = gym.spaces.Discrete(2)

    def __init__(self, pause=0.0, fail_after=None):
        self.pause, self.left = pause, fail_after

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = int(self.np_random.integers(0, 2))
        return np.array([self.cell], dtype=np.float32), {}

    def step(self, action):
        time.sleep(self.pause)
        if self.left is not None:
            self.left -= 1
            if self.left < 0:
                raise ValueError("the motor is broken")
        self.cell = min(max(self.cell + 2 * int(action) - 1, 0), 4)
        return np.array([self.cell], dtype=np.float32), -1.0, self.cell == 4, False, {}


gym.register("Walk-v0", entry_point=Walk)
'''


def environment(folder: Path | None = None, **changes: str | None) -> dict[str, str]:
    """The environment variables of the process: no display; with a folder, ``toys:Walk-v0`` can be imported from it."""
    variables = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    variables |= {"MPLBACKEND": "Agg", "COLUMNS": "80"}
    if folder is not None:
        (folder / "toys.py").write_text(TOYS)
        variables["PYTHONPATH"] = os.pathsep.join([str(folder), *filter(None, [os.environ.get("PYTHONPATH")])])
    return variables | {name: value for name, value in changes.items() if value is not None}


def qtab(*arguments: str, cwd: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Runs the command in a process of its own."""
    return subprocess.run(
        [*QTAB, *arguments], cwd=cwd, env=environment(cwd, **variables), capture_output=True, text=True, check=False
    )


def qtab_here(*arguments: str, cwd: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Runs the command in this process, which saves the second that its imports take."""
    out, err = io.StringIO(), io.StringIO()
    before = Path.cwd()
    os.chdir(cwd)
    try:
        with (
            mock.patch.dict(os.environ, environment(cwd, **variables), clear=True),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
        ):
            try:
                code: Any = main(list(arguments))
            except SystemExit as error:
                code = error.code
    finally:
        os.chdir(before)
    return subprocess.CompletedProcess(["qtab", *arguments], code, out.getvalue(), err.getvalue())


def with_run(folder: Path, **settings: Any) -> Path:
    """Saves a run on FrozenLake as ``run.npz`` in a folder for commands, which is returned."""
    train("FrozenLake-v1", seed=0, **settings).save(folder / "run.npz")
    return folder


def refused(*arguments: str, cwd: Path, run: Callable[..., Any] = qtab_here, **variables: str) -> str:
    """Runs a command that must be refused, with exit code 2, no output and no file, and returns its line of error."""
    before = sorted(cwd.iterdir())
    done = run(*arguments, cwd=cwd, **variables)
    assert done.returncode == 2, done
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1, done.stderr
    assert [path for path in sorted(cwd.iterdir()) if path.suffix not in (".py", "")] == [
        path for path in before if path.suffix not in (".py", "")
    ]
    return str(done.stderr.strip())
