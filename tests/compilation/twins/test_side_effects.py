"""Environments whose methods may have effects outside of them are refused before anything of them is run."""

import os
import re
from collections.abc import Callable
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.twins.class_twin import restored, twin_of
from qtab.compilation.twins.side_effects import refuse_effects
from support.environments.gym_classes import effects
from support.environments.gym_classes.effects import (
    CHANGING_DATA,
    OUTPUT,
    RAN,
    REFUSED,
    CallsAttribute,
    Quiet,
    StepPrints,
)
from support.environments.marked import marked_line


@pytest.mark.parametrize("cls", [one for one in REFUSED if one not in CHANGING_DATA], ids=lambda one: one.__name__)
def test_effects_are_refused_and_never_happen(
    cls: Callable[[], gym.Env], capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    env, numpy_state = cls(), repr(np.random.get_state())  # noqa: NPY002
    with pytest.raises(NotCompilable) as caught:
        refuse_effects(env)
    if cls is not CallsAttribute:
        assert (caught.value.file, caught.value.line) == (effects.__file__, marked_line(cls))  # type: ignore[arg-type]
    assert caught.value.advice
    assert not RAN
    assert effects.COUNT == effects.SCORES["steps"] == 0
    assert effects.CountsInClass.count == effects.CountsInItsClass.count == 0
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
    assert (RAN, effects.BOARD, Quiet.shared.tolist()) == ([], [0, 0, 0], [0.0, 0.0, 0.0])


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


def test_training_steps_such_a_class_in_python_or_names_the_line(capsys: pytest.CaptureFixture[str]) -> None:
    run = qtab.train(StepPrints(), episodes=2, max_episode_steps=10, seed=0, progress=False)
    assert run.config.backend == "gymnasium"
    assert capsys.readouterr().out.count("step") == run.episode_lengths.sum()
    place = f"{effects.__file__}:{marked_line(StepPrints)}: print is called; log in a wrapper or a callback"
    with pytest.raises(ValueError, match=re.escape(place)):
        qtab.train(StepPrints(), episodes=2, max_episode_steps=10, seed=0, backend="numba")
