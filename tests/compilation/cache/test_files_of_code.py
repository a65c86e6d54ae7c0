"""Compiled code is stored once for all processes, by everything it depends on, and loaded without Numba."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from qtab.compilation.cache import code_files

pytest.importorskip("numba")

SOURCE = """
import gymnasium as gym
import numpy as np

import qtab

STEP = 1


class Counter(qtab.FunctionalEnv):
    observation_space = gym.spaces.Discrete(10)
    action_space = gym.spaces.Discrete(2)

    def __init__(self, slip=0.25):
        self.slip = slip

    def initial_state(self, rng):
        return 0

    def transition(self, state, action, rng):
        if rng.random() < self.slip:
            return state, -1.0, False
        return state + STEP, -1.0, state + STEP >= 9

    def observe(self, state):
        return state
"""
PROGRAM = """
import json, sys
import numpy as np
import counter
from qtab.compilation.interface.compiled_env import Stepper
from qtab.compilation.functional import compiled_env

found = []
for slip in json.loads(sys.argv[1]):
    compiled, parameters = compiled_env(counter.Counter(slip))
    stepper = Stepper(compiled, parameters.memory(), np.random.PCG64(1))
    stepper.reset()
    steps = 0
    while stepper.step(0) == 0:
        steps += 1
    found.append(steps)
print(json.dumps({"steps": found, "numba": "numba" in sys.modules}))
"""


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., Any]:
    (tmp_path / "counter.py").write_text(SOURCE)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}

    def start(*slips: float) -> "subprocess.Popen[str]":
        command = [sys.executable, "-B", "-c", PROGRAM, json.dumps(slips)]
        return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)

    return start


def answer(process: "subprocess.Popen[str]") -> Any:
    printed, _ = process.communicate()
    assert process.returncode == 0
    return json.loads(printed)


def files(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("*.compiled"))


def test_the_second_process_loads_the_code_without_numba(run: Callable[..., Any], tmp_path: Path) -> None:
    first, second = answer(run(0.25)), answer(run(0.25))
    assert first == {"steps": second["steps"], "numba": True}
    assert second["numba"] is False
    assert len(files(tmp_path / "__pycache__")) == 1
    assert not [path for path in (tmp_path / "__pycache__").iterdir() if path.name.startswith(".qtab-")]


def test_other_numbers_need_no_other_code(run: Callable[..., Any], tmp_path: Path) -> None:
    found = answer(run(0.0, 0.5, 0.9))["steps"]
    assert found[0] == 8
    assert found == sorted(set(found))
    assert len(files(tmp_path / "__pycache__")) == 1


def test_a_change_of_the_source_or_of_a_type_is_noticed(run: Callable[..., Any], tmp_path: Path) -> None:
    answer(run(0.0))
    (tmp_path / "counter.py").write_text(SOURCE.replace("STEP = 1", "STEP = 3"))
    assert answer(run(0.0)) == {"steps": [2], "numba": True}
    assert answer(run(0)) == {"steps": [2], "numba": True}
    assert len(files(tmp_path / "__pycache__")) == 3


def test_a_damaged_file_is_written_again(run: Callable[..., Any], tmp_path: Path) -> None:
    expected = answer(run(0.25))
    (path,) = (tmp_path / "__pycache__").glob("*.compiled")
    content = path.read_bytes()
    for damaged in (content[:-100], b"", content[:200] + b"x" + content[201:]):
        path.write_bytes(damaged)
        assert answer(run(0.25)) == expected
        assert path.read_bytes() != damaged


def test_several_processes_can_write_at_once(run: Callable[..., Any], tmp_path: Path) -> None:
    processes = [run(0.25) for _ in range(3)]
    assert len({json.dumps(answer(process)["steps"]) for process in processes}) == 1
    assert answer(run(0.25))["numba"] is False


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() == 0, reason="the administrator can write everywhere")
def test_a_read_only_folder_is_left_alone(run: Callable[..., Any], tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        answer(run(0.25))
        assert answer(run(0.25))["numba"] is False
        assert not (tmp_path / "__pycache__").exists()
    finally:
        tmp_path.chmod(0o700)


def test_a_folder_that_cannot_be_made_leads_to_the_users_cache(run: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "__pycache__").write_text("not a folder")
    answer(run(0.25))
    assert answer(run(0.25))["numba"] is False
    assert len(files(tmp_path / "cache" / "qtab" / "compiled")) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such modes")
def test_files_that_other_users_can_write_are_not_loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "code"
    monkeypatch.setattr(code_files, "_folders", lambda _: iter([folder]))
    path = code_files.write("", "0", None, {"refusal": []})
    assert path is not None
    folder.chmod(0o755)
    assert code_files.read("", "0") is not None
    path.chmod(0o666)
    assert code_files.read("", "0") is None
    path.chmod(0o600)
    folder.chmod(0o777)
    assert code_files.read("", "0") is None
    folder.chmod(0o755)
    path.rename(tmp_path / "moved")
    path.symlink_to(tmp_path / "moved")
    assert code_files.read("", "0") is None


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such modes")
def test_beside_a_folder_of_a_group_the_users_cache_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(code_files, "_cache", lambda: tmp_path / "cache")
    source = tmp_path / "source.py"
    source.write_text("")
    (tmp_path / "__pycache__").mkdir()
    (tmp_path / "__pycache__").chmod(0o775)
    path = code_files.write(str(source), "0", None, {"refusal": []})
    assert path is not None
    assert path.parent == tmp_path / "cache" / "qtab" / "compiled"
    assert path.parent.stat().st_mode & 0o777 == 0o700
    assert code_files.read(str(source), "0") is not None
