"""The tables of docs/how_to/spaces.md: what trains verifies equal; what is refused then trains as they say."""

import re
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from types import SimpleNamespace
from typing import Any

import gymnasium
import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces, wrappers

import qtab
from support.environments import Sampled
from support.repository import ROOT

PAGE = (ROOT / "docs/how_to/spaces.md").read_text(encoding="utf-8")
NAMES: dict[str, Any] = {"np": np, "gymnasium": gymnasium, **vars(spaces), **vars(wrappers)}
SETTINGS: dict[str, Any] = {"episodes": 3, "seed": 1, "max_episode_steps": 12, "progress": False}
IMAGES = ("AddRenderObservation", "RenderCollection")


def rows(heading: str) -> Iterator[list[str]]:
    """The cells of the table under a heading, without the outer spaces."""
    section = PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]
    table = [line for line in section.splitlines() if line.startswith("|")]
    for line in table[2:]:
        yield [cell.strip() for cell in line.strip("|").split(" | ")]


def code(cell: str) -> str:
    (found,) = re.findall(r"^`([^`]+)`$", cell)
    return str(found)


SPACES = [(code(space), happens, code(write)) for space, happens, write in rows("Observation spaces")]
WRAPPERS = [
    (code(wrapper), name, happens, code(write))
    for heading in ("Wrappers", "Wrappers over LunarLander")
    for wrapper, over, happens, write in rows(heading)
    for name in re.findall(r"`([^`]+)`", over)
]


def cases() -> Iterator[Any]:
    """The lines about wrappers; slow are those with frames, of Box2D, and a second Box and a second discrete space."""
    for wrapper, name, happens, write in WRAPPERS:
        again = happens == "trains with the preset" and name in ("CartPole-v1", "FrozenLake-v1")
        slow = again or "Lander" in name or any(image in wrapper for image in IMAGES)
        marks = [pytest.mark.slow] if slow else []
        yield pytest.param(wrapper, name, happens, write, marks=marks, id=f"{wrapper}-{name}")


def check(make: Callable[[], gym.Env], happens: str, write: str) -> None:
    """Follows a line of a table."""
    train: Any = partial(qtab.train, **SETTINGS)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Gymnasium's wrappers warn
        if happens.startswith("refused"):
            with pytest.raises(ValueError, match=r"must (be|give|have|consist|hold)|too many for a row each"):
                train(make())
        namespace = {**NAMES, "qtab": SimpleNamespace(train=train), "env": make()}
        run = eval(write, namespace)  # noqa: S307 - our own page
        again = eval(write, {**namespace, "qtab": SimpleNamespace(train=lambda env, **_: env), "env": make()})  # noqa: S307
        assert run.episode_lengths.sum() > 3
        assert qtab.verify(run, env=again).equal


@pytest.mark.parametrize(("space", "happens", "write"), SPACES, ids=[space for space, *_ in SPACES])
def test_a_space_is_served_as_documented(space: str, happens: str, write: str) -> None:
    check(lambda: Sampled(eval(space, NAMES)), happens, write)  # noqa: S307


@pytest.mark.parametrize(("wrapper", "name", "happens", "write"), list(cases()))
def test_a_wrapper_is_served_as_documented(wrapper: str, name: str, happens: str, write: str) -> None:
    if any(image in wrapper for image in IMAGES):
        pytest.importorskip("pygame", reason="frames need pygame")
    if "Grayscale" in wrapper or "Resize" in wrapper or "Obstruct" in wrapper:
        pytest.importorskip("cv2", reason="Gymnasium changes images with OpenCV")

    if "Lander" in name:
        pytest.importorskip("Box2D", reason="LunarLander needs Box2D")

    def make() -> gym.Env:
        kwargs: dict[str, Any] = {"render_mode": "rgb_array"} if any(image in wrapper for image in IMAGES) else {}
        made: gym.Env = eval(wrapper, {**NAMES, "env": gym.make(name, **kwargs)})  # noqa: S307
        return made

    check(make, happens, write)


def test_every_wrapper_of_gymnasium_is_documented() -> None:
    assert [name for name in wrappers.__all__ if not re.search(rf"\b{name}\b", PAGE)] == []
    assert len(WRAPPERS) > 80
