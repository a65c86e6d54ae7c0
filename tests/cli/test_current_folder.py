"""Environments registered in a module of the current folder."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import qtab
from support.processes.command import TOYS, environment

SCRIPT = "import sys\nfrom qtab.cli import main\nsys.exit(main())\n"
"""The installed command ``qtab``, whose folder Python puts on the search path instead of the current one."""


def run(folder: Path, *arguments: str, **changes: str) -> "subprocess.CompletedProcess[str]":
    (folder / "bin").mkdir(exist_ok=True)
    script = folder / "bin" / "qtab"
    script.write_text(SCRIPT)
    variables = {name: value for name, value in environment().items() if name != "PYTHONSAFEPATH"} | changes
    variables["PYTHONPATH"] = os.pathsep.join([str(Path(qtab.__file__).parents[1])])
    command = [sys.executable, str(script), *arguments]
    return subprocess.run(command, cwd=folder, env=variables, capture_output=True, text=True, check=False)


ARGUMENTS = ("train", "parts:Walk-v0", "--episodes", "5", "--seed", "0", "--max-episode-steps", "20", "--scale", "1")


def test_a_module_of_the_current_folder_registers_its_environment(tmp_path: Path) -> None:
    (tmp_path / "parts.py").write_text(TOYS)
    done = run(tmp_path, *ARGUMENTS)
    assert done.returncode == 0, done.stderr
    assert "Walk-v0" in done.stdout


def test_a_file_of_the_current_folder_replaces_no_other_module(tmp_path: Path) -> None:
    (tmp_path / "parts.py").write_text("import colorsys\n" + TOYS)
    for name in ("colorsys.py", "random.py", "gymnasium.py", "qtab.py"):
        (tmp_path / name).write_text("raise RuntimeError('this is a file of the user')\n")
    done = run(tmp_path, *ARGUMENTS)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(sys.version_info < (3, 11), reason="PYTHONSAFEPATH came with Python 3.11")
def test_a_safe_path_excludes_the_current_folder(tmp_path: Path) -> None:
    (tmp_path / "parts.py").write_text(TOYS)
    done = run(tmp_path, *ARGUMENTS, PYTHONSAFEPATH="1")
    assert done.returncode == 2
    assert "parts" in done.stderr


def test_a_call_in_python_leaves_the_search_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from qtab.cli import main

    monkeypatch.chdir(tmp_path)
    before = list(sys.path)
    assert main(["--version"]) == 0
    assert sys.path == before
