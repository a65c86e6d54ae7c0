"""A class whose lines moved gets messages for its new lines; each problem is listed once."""

import importlib.util
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from qtab.compilation import NotCompilable

pytest.importorskip("numba")

SOURCE = """
import gymnasium as gym


class Counter(gym.Env):
    observation_space = gym.spaces.Discrete(10)
    action_space = gym.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        return self.cell, {}

    def step(self, action):
        self.cell += 1
        return self.cell, 1.0, self.cell == 9, False, {}
"""


def test_lines_are_a_part_of_the_digest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from qtab.compilation import ordinary

    digests: list[str] = []
    monkeypatch.setattr(ordinary, "_store", SimpleNamespace(compiled=lambda of, *_: digests.append(of.text)))
    comments = "    # a comment\n" * 5
    moved = SOURCE.replace("        self.cell += 1", comments + "        self.cell += 1")
    for number, source in enumerate((SOURCE, SOURCE, moved)):
        path = tmp_path / str(number) / "counter.py"
        path.parent.mkdir()
        path.write_text(source)
        spec: Any = importlib.util.spec_from_file_location("counter", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        ordinary.OrdinaryEnv(module.Counter())
    assert digests[0] == digests[1] != digests[2]


def test_a_problem_of_two_rewritten_lines_is_listed_once() -> None:
    from qtab.compilation.ordinary import _of_users_line

    first, second, third = (NotCompilable("a power", "<Counter>", line, "write products") for line in (3, 9, 12))
    refusal = NotCompilable(first.reason, first.file, first.line, first.advice, [second, third])
    mapped = _of_users_line({3: ("counter.py", 7), 9: ("counter.py", 7), 12: ("counter.py", 8)}, refusal)
    assert mapped.problems == ["counter.py:7: a power; write products", "counter.py:8: a power; write products"]
