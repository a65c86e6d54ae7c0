"""Spaces with parts: the functions write the components of an observation in the order of the space."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gymnasium import spaces

import qtab
from support.native.board import SETTINGS, Board, board_library
from support.native.libraries import capsule_of, needs_compiler

pytestmark = needs_compiler
X, Y = spaces.Discrete(5, start=-2), spaces.Discrete(3, start=3)
SPACES: dict[str, spaces.Space[Any]] = {
    "tuple": spaces.Tuple((X, Y)),
    "dict": spaces.Dict({"x": X, "y": Y}),
    "grid": spaces.MultiDiscrete(np.array([[5], [3]]), start=np.array([[-2], [3]])),
    "integers": spaces.Box(np.array([-2, 3]), np.array([2, 5]), dtype=np.int64),
    "mixed": spaces.Dict({"x": X, "y": spaces.Box(3.0, 5.0, (1,), np.float64)}),
    "single": spaces.Tuple((spaces.Box(-2.0, 2.0, (), np.float32), Y)),
}


class Shown(Board):
    """The board with another observation space."""

    def __init__(self, space: str) -> None:
        self.observation_space: Any = SPACES[space]

    def _answer(self) -> tuple[Any, dict[str, Any]]:
        (x, y), info = super()._answer()
        shown: Any
        match self.observation_space:
            case spaces.Tuple(spaces=(spaces.Box(), _)):
                shown = (np.array(x, np.float32), y)
            case spaces.Tuple():
                shown = (x, y)
            case spaces.Dict():
                is_box = isinstance(self.observation_space["y"], spaces.Box)
                shown = {"x": x, "y": np.array([y], np.float64) if is_box else y}
            case space:
                shown = np.array([x, y]).reshape(space.shape)
        return shown, info


class Compiled(Shown):
    """The same, which Rust steps by its capsule."""

    library: Path

    def __qtab_env__(self) -> Any:
        return capsule_of(self.library)


@pytest.mark.parametrize(
    "settings",
    [{}, {"time_aware": True, "on_truncation": "terminate"}],
    ids=["plain", "time_aware"],
)
@pytest.mark.parametrize("space", SPACES)
def test_the_numbers_are_those_of_python(tmp_path: Path, space: str, settings: dict[str, Any]) -> None:
    floats = {"TYPE": "QTAB_FLOAT64", "NUMBER": "double"} if space in ("mixed", "single") else {}
    ours, theirs = Compiled(space), Shown(space)
    ours.library = board_library(tmp_path, **floats)
    settings = {**SETTINGS, **settings}
    if space in ("mixed", "single"):
        settings |= {"discretizer": "bins", "bins": [4]}
    one, other = (qtab.train(env, seed=6, **settings) for env in (ours, theirs))
    assert (one.config.backend, other.config.backend) == ("rust", "gymnasium")
    for name in ("tables", "episode_returns", "episode_lengths"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name
    assert qtab.verify(one, env=ours).equal


def test_tiles_beside_an_index(tmp_path: Path) -> None:
    settings: dict[str, Any] = {**SETTINGS, "discretizer": "tiles", "tiles": [3], "tilings": 4}
    ours = Compiled("mixed")
    ours.library = board_library(tmp_path, TYPE="QTAB_FLOAT64", NUMBER="double")
    one, other = (qtab.train(env, seed=6, **settings) for env in (ours, Shown("mixed")))
    assert one.config.backend == "rust"
    assert one.tables.tobytes() == other.tables.tobytes()


def test_an_observation_outside_the_space_is_named_by_its_key(tmp_path: Path) -> None:
    env = Compiled("dict")
    env.library = board_library(tmp_path, BAD_OBSERVATION=6)
    with pytest.raises(ValueError, match=r"observation\['y'\] is 6, outside the observation space"):
        qtab.train(env, seed=0, **SETTINGS)
