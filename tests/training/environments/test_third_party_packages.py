"""Environments of other packages, in the versions of the extra third-party."""

import importlib
from typing import Any

import gymnasium as gym
import pytest
from gymnasium.wrappers import FilterObservation

import qtab

pytestmark = [pytest.mark.third_party, pytest.mark.filterwarnings("ignore")]
SETTINGS: dict[str, Any] = {"episodes": 5, "seed": 0, "max_episode_steps": 100, "initial_q": 0.0}
GRID = "MiniGrid-Empty-5x5-v0"
SYMBOLS = "DictObservationSpaceWrapper", "FullyObsWrapper", "OneHotPartialObsWrapper", "PositionBonus"


def registered(package: str) -> Any:
    """Imports a package and registers its environments, or skips the test."""
    module = pytest.importorskip(package, reason=f"needs {package}")
    gym.register_envs(module)
    return module


def check(make: Any, refused: str, **settings: Any) -> qtab.Run:
    """An environment is refused as it is, and trains and verifies with settings."""
    with pytest.raises(ValueError, match=refused):
        qtab.train(make(), **SETTINGS)
    run = qtab.train(make(), **{**SETTINGS, **settings})
    assert qtab.verify(run, env=make()).equal
    return run


def test_a_room_of_minigrid_needs_a_row_for_what_is_met() -> None:
    registered("minigrid")

    def view(observation: Any) -> tuple[int, ...]:
        return int(observation["direction"]), *observation["image"].ravel().tolist()

    whole = check(
        lambda: gym.make(GRID), r"FilterObservation\(env, \[.*\]\) leaves it out", discretizer=view, max_rows=500
    )

    def filtered() -> gym.Env:
        return FilterObservation(gym.make(GRID), ["direction", "image"])

    run = check(filtered, "max_rows= assigns rows only to the images that are seen", max_rows=500)
    assert run.episode_returns.tobytes() == whole.episode_returns.tobytes()
    assert 10 < run.discretizer.n_seen == whole.discretizer.n_seen < 100  # type: ignore[attr-defined]


@pytest.mark.parametrize("wrapper", SYMBOLS)
def test_a_wrapper_of_minigrid_is_served(wrapper: str) -> None:
    registered("minigrid")
    wrap = getattr(importlib.import_module("minigrid.wrappers"), wrapper)
    check(lambda: FilterObservation(wrap(gym.make(GRID)), ["direction", "image"]), "max_rows=", max_rows=500)


@pytest.mark.parametrize("wrapper", ["ImgObsWrapper", "FlatObsWrapper"])
def test_a_flat_wrapper_of_minigrid_is_served(wrapper: str) -> None:
    registered("minigrid")
    wrap = getattr(importlib.import_module("minigrid.wrappers"), wrapper)
    check(lambda: wrap(gym.make(GRID)), "max_rows=", max_rows=500)


@pytest.mark.parametrize(
    "settings",
    [
        {"max_rows": 3000},
        {"discretizer": "tiles", "tiles": 2, "hashed_rows": 2**14, "learning_rate": 0.1},
        {"discretizer": lambda ram: (int(ram[49]) // 32, int(ram[54]) // 32), "shape": (8, 8)},
    ],
    ids=["rows", "tiles", "function"],
)
def test_the_memory_of_an_atari_game_is_served(settings: dict[str, Any]) -> None:
    registered("ale_py")
    check(lambda: gym.make("ALE/Pong-v5", obs_type="ram"), "max_rows=", **settings)


def test_the_classic_environments_are_served_as_they_are() -> None:
    classics = pytest.importorskip("gym_classics", reason="needs gym_classics")
    classics.register("gymnasium")
    ids = [name for name, spec in gym.registry.items() if "gym_classics" in str(spec.entry_point)]
    assert len(ids) > 10
    for name in ids:
        run = qtab.train(gym.make(name), **SETTINGS)
        report = qtab.verify(run, env=gym.make(name))
        # The car rental gives its distributions the generator of the reset before.
        assert report.repeats is False if name.startswith("JacksCarRental") else report.equal


LIMITS = {"low": [-1] * 25, "high": [1] * 25}


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("highway-fast-v0", {"discretizer": "tiles", "tiles": 2, "hashed_rows": 4096, **LIMITS}),
        ("merge-v1", {"discretizer": "bins", "bins": 3, "max_rows": 500, **LIMITS}),
        ("parking-v0", {"actions": 3, "discretizer": lambda o: int(o["observation"][0] > 0), "shape": 2}),
    ],
)
def test_a_road_is_served(name: str, settings: dict[str, Any]) -> None:
    registered("highway_env")
    refused = "must have finite bounds" if "actions" not in settings else "actions must be given"
    check(lambda: gym.make(name), refused, **{**settings, "max_episode_steps": 20})
