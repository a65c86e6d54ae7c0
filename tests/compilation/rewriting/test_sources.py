"""A file that was edited after its class was imported is never compiled in place of the class that runs."""

import ast
import importlib.util
import linecache
import sys
from pathlib import Path
from typing import Any

import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.lockstep.rewriting import assert_equal_steps

SOURCE = """
import gymnasium as gym


class Edited(gym.Env):
    action_space = gym.spaces.Discrete(2)
    observation_space = gym.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.s = 0
        return 0, {}

    def step(self, action):
        assert action >= 0
        self.s = self.s + 1 if action == 1 else 0
        return 0, (100.0 if self.s > 40 else 0.0), False, False, {}
"""
EDITS = [
    ("100.0", "777.0"),
    ("0.0)", "-0.0)"),
    ("self.s > 40", "self.s > 40.0"),
    ("action >= 0", "action >= -1"),
    ("    def step", "\n    def step"),
]


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "edited_class.py"
    path.write_text(SOURCE, encoding="utf-8")
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    return path


def imported(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: edit[1].strip())
def test_an_edited_file_is_refused(file: Path, edit: tuple[str, str]) -> None:
    module = imported(file)
    file.write_text(SOURCE.replace(*edit), encoding="utf-8")
    with pytest.raises(NotCompilable, match="was edited after it was imported"):
        rewrite(module.Edited())
    assert_equal_steps(imported(file).Edited(), rewrite(imported(file).Edited()), 20)


def test_an_edit_that_changes_no_code_is_accepted(file: Path) -> None:
    module = imported(file)
    file.write_text(SOURCE + "\n# a comment\n", encoding="utf-8")
    assert_equal_steps(module.Edited(), rewrite(module.Edited()), 20)


def test_a_cell_of_a_notebook_with_imports_above_the_class_is_accepted(monkeypatch: pytest.MonkeyPatch) -> None:
    text = SOURCE.replace("return 0, (", "return int(np.sqrt(1.0)) - 1, (").replace("\n", "\nimport numpy as np\n", 1)
    cell, namespace = "<ipython-input-1>", {"__name__": "__main__"}
    monkeypatch.setitem(linecache.cache, cell, (len(text), None, text.splitlines(keepends=True), cell))
    for statement in ast.parse(text).body:  # as IPython runs a cell
        exec(compile(ast.Module([statement], []), cell, "exec"), namespace)  # noqa: S102 - the cell above
    made: Any = namespace["Edited"]
    assert_equal_steps(made(), rewrite(made()), 20)
