"""A wrong action mask raises the error of Python stepping, and none in a run that does not read the masks."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.compilation.twins.class_twin import wrong_mask

pytest.importorskip("numba")

CALLS: list[int] = []
SETTINGS: dict[str, Any] = {"episodes": 40, "max_episode_steps": 50, "seed": 4, "progress": False}


class Method(gym.Env):
    """Leaves no action from cell 12 on."""

    observation_space = gym.spaces.Discrete(20)
    action_space = gym.spaces.Discrete(2)

    def action_masks(self):
        return np.array([self.cell < 12, self.cell < 12])

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        return self.cell, {}

    def step(self, action):
        self.cell = min(self.cell + int(action), 19)
        return self.cell, self.np_random.random(), self.cell == 19, False, {}


class Info(gym.Env):
    """Has a 2 in its mask from cell 12 on."""

    observation_space = gym.spaces.Discrete(20)
    action_space = gym.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        return self.cell, {"action_mask": np.array([1, 1 + self.cell // 12])}

    def step(self, action):
        self.cell = min(self.cell + int(action), 19)
        return self.cell, 0.0, self.cell == 19, False, {"action_mask": np.array([1, 1 + self.cell // 12])}


class Raises(Method):
    """Raises an error instead of giving a mask from cell 12 on."""

    last = 11

    def action_masks(self):
        if self.cell > self.last:
            raise IndexError("no mask")
        return np.array([True, True])


class RaisesAtTheEnd(Raises):
    """Raises the error in its terminal state only."""

    last = 18


class Counts(Method):
    """Its mask has an effect, so that it is not compiled."""

    def action_masks(self):
        CALLS.append(self.cell)
        return np.array([True, True])


class Walled(Method):
    """Begins in a cell without actions at times."""

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = int(self.np_random.integers(14))
        return self.cell, {}


@pytest.fixture(autouse=True)
def _files_of_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.mark.parametrize(
    ("cls", "message"),
    [
        (Method, r"action_mask\(12\) must leave at least one action, got array\(\[False, False\]\)"),
        (Info, r"info\['action_mask'\] of step of .*Info.* must hold booleans, or 0 and 1, got array\(\[1, 2\]\)"),
    ],
)
def test_the_error_is_that_of_python(cls: Any, message: str) -> None:
    errors = []
    for backend in ("numba", "python"):
        with pytest.raises(ValueError, match=message) as caught:
            qtab.train(cls(), action_mask=True, backend=backend, **SETTINGS)
        errors.append(str(caught.value))
    assert errors[0] == errors[1]


@pytest.mark.parametrize(
    ("cls", "action_mask"), [(Method, False), (Raises, False), (RaisesAtTheEnd, True), (Walled, False)]
)
def test_masks_that_python_does_not_read_are_not_read(cls: Any, action_mask: bool) -> None:
    runs = [qtab.train(cls(), action_mask=action_mask, backend=one, **SETTINGS) for one in ("numba", "python")]
    assert runs[0].config.backend == "numba"
    assert runs[0].tables.tobytes() == runs[1].tables.tobytes()
    assert runs[0].episode_returns.tobytes() == runs[1].episode_returns.tobytes()


def test_masks_that_are_not_compiled_are_not_computed() -> None:
    with pytest.raises(ValueError, match=r"a list is changed in `CALLS\.append"):
        qtab.train(Counts(), action_mask=True, backend="numba", **SETTINGS)
    assert qtab.train(Counts(), action_mask=False, backend="numba", **SETTINGS).config.backend == "numba"
    assert CALLS == []


def test_what_is_wrong_with_a_mask() -> None:
    assert wrong_mask(np.ones(3), 2) == "have shape (2,), with an item for each action"
    assert wrong_mask(np.zeros(2, bool), 2) == "leave at least one action"
    assert wrong_mask(np.zeros(2, bool), 2, ended=True) is None
    assert wrong_mask([0, 1], 2) is None
