"""The tables that Rust makes are Gymnasium's, to the last bit, and only Gymnasium's own environments have them."""

import functools
from typing import Any

import gymnasium as gym
import pytest
from gymnasium.envs.toy_text import cliffwalking, frozen_lake, taxi
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab import _core
from qtab.envs.in_rust import native
from qtab.envs.in_rust.native import known_table
from support.parity import assert_same_run

IDS = ("CliffWalking-v1", "CliffWalkingSlippery-v1", "FrozenLake-v1", "FrozenLake8x8-v1", "Taxi-v4")
SETTINGS: dict[str, Any] = {"episodes": 30, "max_episode_steps": 40}
SHORT: dict[str, Any] = {**SETTINGS, "seed": 3}


def table_of(env: Any) -> _core.TransitionTable:
    return _core.TransitionTable(env.unwrapped.P, env.unwrapped.initial_state_distrib)


def check(name: str, **kwargs: Any) -> None:
    known: Any = known_table(gym.spec(name), kwargs)
    theirs: Any = gym.make(name, **kwargs)
    assert table_of(theirs) == known.P
    assert (known.observation_space, known.action_space) == (theirs.observation_space, theirs.action_space)
    for attribute in ("fickle_passenger", "fickle_probability"):
        assert getattr(known, attribute, None) == getattr(theirs.unwrapped, attribute, None)


@pytest.mark.parametrize("name", [*IDS, *(f"qtab/{name}" for name in IDS)])
def test_the_tables_are_gymnasiums(name: str) -> None:
    check(name)


@pytest.mark.parametrize("is_slippery", [False, True])
def test_the_cliffs_are_gymnasiums(is_slippery: bool) -> None:
    check("CliffWalking-v1", is_slippery=is_slippery)


REWARDS = st.integers(-10, 10) | st.floats(-1e9, 1e9)


@settings(max_examples=(settings.default or settings()).max_examples // 3)
@given(st.sampled_from(["4x4", "8x8"]), st.booleans(), st.floats(0, 1), st.tuples(REWARDS, REWARDS, REWARDS))
def test_the_lakes_are_gymnasiums(map_name: str, is_slippery: bool, success_rate: float, rewards: Any) -> None:
    check(
        "FrozenLake-v1",
        map_name=map_name,
        is_slippery=is_slippery,
        success_rate=success_rate,
        reward_schedule=rewards,
    )


@settings(max_examples=(settings.default or settings()).max_examples // 3)
@given(st.integers(2, 6).flatmap(lambda width: st.lists(st.text("SFHG", min_size=width, max_size=width), min_size=1)))
def test_edited_maps_of_the_lake_are_followed(lines: list[str]) -> None:
    with pytest.MonkeyPatch.context() as patched:
        patched.setitem(frozen_lake.MAPS, "4x4", lines)
        if any("S" in line for line in lines):
            check("FrozenLake-v1")
        else:
            assert known_table(gym.spec("FrozenLake-v1"), {}) is None


@settings(max_examples=(settings.default or settings()).max_examples // 5)
@given(st.booleans(), st.booleans(), st.floats(0, 1), st.floats(0, 1))
def test_the_taxis_are_gymnasiums(is_rainy: bool, fickle_passenger: bool, rain: float, fickle: float) -> None:
    check(
        "Taxi-v4",
        is_rainy=is_rainy,
        fickle_passenger=fickle_passenger,
        rainy_probability=rain,
        fickle_probability=fickle,
    )


def test_tables_that_differ_are_not_equal() -> None:
    dry, rainy = (_core.TransitionTable.taxi([line.encode() for line in taxi.MAP], rain) for rain in (None, 0.8))
    assert dry != rainy
    assert dry == table_of(gym.make("Taxi-v4"))
    assert _core.TransitionTable.cliff_walking(True) != _core.TransitionTable.cliff_walking(False)


def test_other_walls_of_the_taxi_are_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = [line.replace(":", "|", 1) if index % 2 else line for index, line in enumerate(taxi.MAP)]
    assert lines != taxi.MAP
    monkeypatch.setattr(taxi, "MAP", lines)
    for is_rainy in (False, True):
        check("Taxi-v4", is_rainy=is_rainy)


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The ids of the environments that Gymnasium makes."""
    ids: list[str] = []
    make = gym.make

    def recorded(spec: Any, **kwargs: Any) -> gym.Env:
        ids.append(spec if isinstance(spec, str) else spec.id)
        return make(spec, **kwargs)

    monkeypatch.setattr(gym, "make", recorded)
    return ids


@pytest.mark.parametrize("name", IDS)
def test_gymnasium_makes_no_environment_for_a_known_table(name: str, made: list[str]) -> None:
    run = qtab.train(name, **SHORT)
    runs = qtab.train_many(name, [3], tables=True, **SETTINGS)
    assert made == []
    assert run.config.backend == "rust"
    assert run.tables.tobytes() == runs[0].tables.tobytes()
    assert_same_run(run, qtab.train(gym.make(name, max_episode_steps=40), **SHORT))
    assert_same_run(run, qtab.train(name, backend="gymnasium", **SHORT))
    assert qtab.verify(run).equal


@pytest.mark.parametrize(
    "chosen",
    [
        {"backend": "gymnasium"},
        {"action_mask": True},
        {"discretizer": lambda state: state, "shape": (500,)},
        {"max_rows": 500},
    ],
    ids=["backend", "action_mask", "function", "max_rows"],
)
def test_python_steps_and_masks_the_environment_that_gymnasium_makes(chosen: dict[str, Any], made: list[str]) -> None:
    run = qtab.train("Taxi-v4", **SHORT, **chosen)
    assert made == ["Taxi-v4"]
    assert len(run.episode_returns) == 30


@pytest.mark.parametrize(
    ("name", "kwargs"),
    [
        ("Taxi-v4", {"is_rainy": 1}),
        ("Taxi-v4", {"is_rainy": True, "rainy_probability": 1}),
        ("Taxi-v4", {"is_rainy": True, "rainy_probability": 1.5}),
        ("Taxi-v4", {"render_mode": None}),
        ("CliffWalking-v1", {"nothing": 1}),
        ("FrozenLake-v1", {"desc": ["SF", "FG"]}),
        ("FrozenLake-v1", {"map_name": None}),
        ("FrozenLake-v1", {"map_name": "5x5"}),
        ("FrozenLake-v1", {"success_rate": 1}),
        ("FrozenLake-v1", {"success_rate": 1.5}),
        ("FrozenLake-v1", {"reward_schedule": [1, 0, 0]}),
        ("FrozenLake-v1", {"reward_schedule": (1, 0)}),
        ("FrozenLake-v1", {"reward_schedule": (True, 0, 0)}),
        ("FrozenLake-v1", {"reward_schedule": (10**400, 0, 0)}),
    ],
)
def test_other_arguments_are_left_to_gymnasium(name: str, kwargs: dict[str, Any]) -> None:
    assert known_table(gym.spec(name), kwargs) is None


def free_pickup(env: Any, at: Any, passenger: int, reward: int) -> tuple[int, int]:
    """The passenger is in the taxi at once."""
    return (4, 0) if passenger < 4 else (passenger, reward)


@pytest.mark.parametrize(
    "replacement",
    [
        free_pickup,
        functools.wraps(taxi.TaxiEnv._pickup)(lambda *arguments: free_pickup(*arguments)),
        functools.partialmethod(free_pickup),
        staticmethod(functools.partial(free_pickup, None)),
    ],
    ids=["function", "wraps", "partialmethod", "staticmethod"],
)
def test_a_replaced_method_is_gymnasiums(replacement: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(taxi.TaxiEnv, "_pickup", replacement)
    assert known_table(gym.spec("Taxi-v4"), {}) is None
    run = qtab.train("Taxi-v4", **SHORT)
    assert_same_run(run, qtab.train("Taxi-v4", backend="gymnasium", **SHORT))


def test_a_replaced_class_or_map_and_other_directions_are_gymnasiums(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patched:
        patched.setattr(taxi, "MAP", [*taxi.MAP, "+---------+"])
        assert known_table(gym.spec("Taxi-v4"), {}) is None
    with monkeypatch.context() as patched:
        patched.setattr(taxi, "TaxiEnv", type("TaxiEnv", (taxi.TaxiEnv,), {}))
        assert known_table(gym.spec("Taxi-v4"), {}) is None
    for lines in (["SF", "F"], ["SX", "FG"], ("SF", "FG"), [b"SF", b"FG"], ["S"], []):
        with monkeypatch.context() as patched:
            patched.setitem(frozen_lake.MAPS, "4x4", lines)
            assert known_table(gym.spec("FrozenLake-v1"), {}) is None
    with monkeypatch.context() as patched:
        patched.setattr(frozen_lake, "LEFT", 2)
        assert known_table(gym.spec("FrozenLake-v1"), {}) is None
    monkeypatch.setitem(cliffwalking.POSITION_MAPPING, 0, [1, 0])
    assert known_table(gym.spec("CliffWalking-v1"), {}) is None


def test_another_version_of_gymnasium_makes_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gym, "__version__", "1.5.0")
    assert all(known_table(gym.spec(name), {}) is None for name in IDS)
    assert gym.__version__ != native.VERSION
