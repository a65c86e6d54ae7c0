"""Code that calls the C library or makes arrays is loaded without the import of Numba, and calls the same functions."""

import json
import os
import subprocess
import sys
from importlib.machinery import ExtensionFileLoader
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from qtab.compilation.cache import numba_symbols

pytest.importorskip("numba")

SOURCE = """
import math

import gymnasium as gym
import numpy as np


class Swing(gym.Env):
    observation_space = gym.spaces.Box(-9.0, 9.0, (2,), np.float64)
    action_space = gym.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.x = np.array([0.1, 0.2])
        return self.x.copy(), {}

    def step(self, action):
        self.x = self.x + np.array([math.cos(self.x[1]), math.sin(self.x[0]) - action]) * 0.1
        moved = math.exp(-abs(self.x[0])) + math.atan2(self.x[1], 2.0) + self.x[0] % 0.3
        return self.x.copy(), moved, abs(self.x[0]) > 8.0 or abs(self.x[1]) > 8.0, False, {}
"""
PROGRAM = """
import json, sys
import qtab, swing

settings = {"discretizer": "bins", "bins": [5, 5], "episodes": 5, "max_episode_steps": 50, "seed": 0}
run = qtab.train(swing.Swing(), **settings, backend="numba")
loaded = "numba" in sys.modules
import numba
from numba import _helperlib
from numba.core.runtime import _nrt_python
import numpy as np

summed = numba.njit(lambda n: np.arange(n).astype(np.float64).sum() + np.cos(0.5))(4)
later = qtab.train(swing.Swing(), **settings, backend="gymnasium")
print(json.dumps([loaded, run.q_table.tobytes().hex(), later.q_table.tobytes().hex(), summed]))
"""


def test_a_class_with_arrays_and_the_c_library_is_loaded_without_numba(tmp_path: Path) -> None:
    (tmp_path / "swing.py").write_text(SOURCE)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}

    def started() -> list[object]:
        command = [sys.executable, "-B", "-c", PROGRAM]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        found: list[object] = json.loads(done.stdout)
        return found

    first, second = started(), started()
    assert [first[0], second[0]] == [True, False]
    assert first[1] == first[2] == second[1] == second[2]
    assert first[3] == second[3] == 6.0 + 0.8775825618903728  # Numba works as it did


def test_an_extension_that_cannot_be_loaded_counts_as_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any) -> None:
        raise ImportError("DLL load failed")

    monkeypatch.setattr(numba_symbols, "_loaded", {})
    monkeypatch.delitem(sys.modules, "numba._helperlib", raising=False)
    monkeypatch.setattr(ExtensionFileLoader, "exec_module", fail)
    provided: list[str] = []
    llvm = SimpleNamespace(add_symbol=lambda name, _: provided.append(name))
    assert not numba_symbols.provide(llvm, ["cos"])
    assert provided == []
    assert "numba._helperlib" not in sys.modules
