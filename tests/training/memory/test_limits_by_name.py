"""Errors about too little memory name ``memory_limit`` in the calls that were given one, and in no others."""

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

import qtab
from qtab._utils import memory
from qtab.prediction import LSTD, expected_updates, linear_geometry

LAKE = "FrozenLake-v1"
SHORT: dict[str, Any] = {"episodes": 5, "seed": 0}
SEEDS: dict[str, Any] = {"seeds": 2, "episodes": 5}
GRID = {"discount": [0.9, 0.8]}
LIMITED: Mapping[str, Callable[..., Any]] = {
    "train": lambda **limit: qtab.train(LAKE, **SHORT, **limit),
    "resume": lambda **limit: qtab.resume(qtab.load(SAVED), episodes=9, **limit),
    "train_many": lambda **limit: qtab.train_many(LAKE, **SEEDS, **limit),
    "sweep": lambda **limit: qtab.sweep(LAKE, GRID, **SEEDS, **limit),
    "estimate_values": lambda **limit: qtab.estimate_values(LAKE, "random", episodes=5, **limit),
}
"""The calls that have the argument."""
UNLIMITED: Mapping[str, Callable[[Any], Any]] = {
    "evaluate": lambda made: qtab.evaluate(made["run"], 5),
    "verify": lambda made: qtab.verify(made["run"]),
    "diagnose": lambda made: qtab.diagnose(made["run"], seeds=5),
    "confirm": lambda made: made["sweep"].confirm(seeds=5),
    "linear_geometry": lambda _: linear_geometry("qtab/RandomWalk-v0", "random"),
    "linear_geometry of rows": lambda _: linear_geometry("qtab/RandomWalk-v0", "random", np.arange(19)),
    "expected_updates": lambda made: expected_updates(made["geometry"], "td", 5, 0.1),
    "LSTD": lambda _: LSTD(3),
    "lspi": lambda made: qtab.planning.lspi(qtab.planning.Transitions.recorded(made["run"]), np.eye(16)),
    "book of training": lambda _: qtab.book.find("example-6.6").run(1, progress=False),
    "book of prediction": lambda _: qtab.book.find("example-6.2").run(1, progress=False),
}
SAVED = ""


@pytest.fixture(scope="module")
def made() -> dict[str, Any]:
    """What the calls need, made before memory is short."""
    return {
        "run": qtab.train(LAKE, **SHORT, record=5),
        "sweep": qtab.sweep(LAKE, GRID, **SEEDS),
        "geometry": linear_geometry("qtab/RandomWalk-v0", "random"),
    }


@pytest.fixture
def run_file(made: dict[str, Any], tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    made["run"].save(tmp_path / "run.npz")
    monkeypatch.setitem(globals(), "SAVED", tmp_path / "run.npz")


def a_byte_by_default(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "memory_limit", lambda given: 1 if given is None else given)


def test_every_function_with_a_memory_limit_is_here() -> None:
    functions = {name: getattr(qtab, name) for name in dir(qtab) if inspect.isfunction(getattr(qtab, name))}
    having = {name for name, function in functions.items() if "memory_limit" in inspect.signature(function).parameters}
    assert having == set(LIMITED)


@pytest.mark.usefixtures("run_file")
@pytest.mark.parametrize("name", LIMITED)
def test_a_limit_that_is_given_is_named(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        MemoryError, match=r" would take .*, more than memory_limit=1 \(1 byte\); .* or increase memory_limit"
    ):
        LIMITED[name](memory_limit=1)
    a_byte_by_default(monkeypatch)
    with pytest.raises(
        MemoryError, match=r" would take .*, more than half of the machine's memory \(1 byte\)"
    ) as error:
        LIMITED[name]()
    assert "memory_limit" not in str(error.value)


@pytest.mark.parametrize("name", UNLIMITED)
def test_calls_without_a_limit_do_not_name_one(
    name: str, made: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    a_byte_by_default(monkeypatch)
    with pytest.raises(
        MemoryError, match=r" would take .*, more than half of the machine's memory \(1 byte\)"
    ) as error:
        UNLIMITED[name](made)
    assert "memory_limit" not in str(error.value)


def test_the_steps_that_a_method_stores_stop_at_the_limit_of_the_call() -> None:
    settings: dict[str, Any] = {"method": "offline_lambda_return", "trace_decay": 0.9, "learning_rate": 0.1}
    endless: dict[str, Any] = {"env_kwargs": {"goal_velocity": 1.0}, "discretizer": "bins", "bins": 2}
    with pytest.raises(MemoryError, match=r" would exceed memory_limit=300000 .*, or increase memory_limit"):
        qtab.estimate_values(
            "MountainCar-v0",
            "random",
            episodes=1,
            max_episode_steps=10**6,
            memory_limit=300_000,
            **settings,
            **endless,
        )
