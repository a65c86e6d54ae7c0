"""Compiled code depends on all values, also beside one without a digest, which is kept and not stored in files."""

import gc
import logging
import weakref
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.compilation import functional, ordinary
from qtab.compilation.cache.store import Store
from qtab.compilation.functional import compiled_env
from qtab.compilation.rewriting import helpers
from support.environments.gym_classes import grids

pytest.importorskip("numba")

DEBUG = False
LENGTH = 1
log = logging.getLogger(__name__)


class Walk(qtab.FunctionalEnv):
    observation_space: gym.Space[Any] = gym.spaces.Discrete(10)
    action_space: gym.Space[Any] = gym.spaces.Discrete(2)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        if DEBUG:  # it is not compiled
            log.info("a step")
        following = min(state + LENGTH, 9)
        return following, -1.0, following == 9

    def observe(self, state: Any) -> Any:
        return state


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr("qtab.compilation.cache.code_files._folders", lambda _: iter([tmp_path / "code"]))
    for module in (functional, ordinary):
        monkeypatch.setattr(module, "_store", Store())
    return tmp_path / "code"


def test_another_value_of_a_global_needs_other_code(monkeypatch: pytest.MonkeyPatch, files: Path) -> None:
    for length, steps in ((1, 9), (3, 3), (1, 9)):
        monkeypatch.setattr(f"{__name__}.LENGTH", length)
        run = qtab.train(Walk(), episodes=2, max_episode_steps=50, seed=0, backend="numba")
        assert run.episode_lengths.tolist() == [steps, steps]
    assert not files.exists()


class Log:
    """A value without a digest."""


def test_the_value_is_kept_so_that_no_other_gets_its_address(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{__name__}.log", None)  # restores it; the values are set below, so that it keeps none
    globals()["log"] = Log()
    first = weakref.ref(log)
    one = compiled_env(Walk())[0]
    assert compiled_env(Walk())[0] is one
    globals()["log"] = Log()
    assert compiled_env(Walk())[0] is not one
    gc.collect()
    assert first() is not None


def test_ordinary_classes(monkeypatch: pytest.MonkeyPatch, files: Path) -> None:
    checked = helpers.HELPERS["h_key"]

    def h_key(key: Any, size: Any) -> Any:
        if DEBUG:
            log.info("a key")
        return checked(key, size)

    monkeypatch.setitem(helpers.HELPERS, "h_key", h_key)
    shared: dict[str, Any] = {"episodes": 5, "max_episode_steps": 20, "seed": 2}
    compiled, python = (qtab.train(grids.CliffEnv(), backend=backend, **shared) for backend in ("numba", "gymnasium"))
    assert compiled.tables.tobytes() == python.tables.tobytes()
    assert not files.exists()
