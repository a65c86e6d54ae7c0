"""What is refused about an observation or its space is named as the environment names it, with what would fit."""

import re
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces

import qtab

SHORT: dict[str, Any] = {"seed": 0, "episodes": 2, "max_episode_steps": 3}
WRAPPERS = ("DtypeObservation", "FlattenObservation")
ROOM = spaces.Dict(
    {"speed": spaces.Box(-1, 1, (2,), np.float32), "floor": spaces.Discrete(4, start=5), "lamps": spaces.MultiBinary(2)}
)


class Still(gym.Env[Any, Any]):
    """Shows the same observation at every step."""

    action_space = spaces.Discrete(2)

    def __init__(self, space: spaces.Space[Any], shown: Any = None) -> None:
        self.observation_space = space
        self.shown = space.sample() if shown is None else shown

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        return self.observation_space.sample(), {}

    def step(self, action: int) -> Any:
        return self.shown, -1.0, False, False, {}


def room(**changes: Any) -> dict[str, Any]:
    return {"speed": np.zeros(2, np.float32), "floor": 5, "lamps": np.zeros(2, np.int8)} | changes


WRONG = [
    (room(floor=12), r"observation\['floor'\] is 12, outside"),
    (room(floor=2), r"observation\['floor'\] is 2, outside"),
    (room(lamps=np.array([0, 2])), r"observation\['lamps'\]\[1\] is 2, outside"),
    (room(speed=np.array([0, np.nan], np.float32)), r"observation\['speed'\]\[1\] is NaN, outside"),
]


@pytest.mark.parametrize(("observation", "message"), WRONG)
def test_a_component_of_an_observation_is_named_by_its_keys(observation: Any, message: str) -> None:
    run = qtab.train(Still(ROOM), discretizer="bins", bins=3, **SHORT)
    with pytest.raises(ValueError, match=rf"^{message}"):
        run.predict(observation)
    with pytest.raises(ValueError, match=rf"^{message}"):
        qtab.train(Still(ROOM, observation), discretizer="bins", bins=3, **SHORT)
    batch = {key: np.stack([room()[key], value]) for key, value in observation.items()}
    with pytest.raises(ValueError, match=message.replace("observation", r"^observations\[1\]", 1)):
        run.predict(batch)


@pytest.mark.parametrize(
    ("space", "settings", "message"),
    [
        (spaces.MultiDiscrete([1] * 63), {}, "the observation space must give the table at most 62 axes, .* got 63"),
        (spaces.Box(0, 1, (70,)), {"discretizer": "bins", "bins": 1}, "at most 62 axes, .*max_rows= .* got 70"),
        (spaces.Discrete(1), {"discretizer": lambda _: 0, "shape": (1,) * 63}, "^shape must give .*at most 62 axes"),
        (
            spaces.Box(-(2**63), 2**63 - 1, (1,), np.int64),
            {},
            "^observation holds integers from -9223372036854775808 to 9223372036854775807, too many for a row each: "
            "max_rows= .* discretizer='bins' or 'tiles'",
        ),
        (
            spaces.Dict({"n": spaces.Box(0, 10**9, (1,), np.int32)}),
            {},
            r"^observation\['n'\] holds integers from 0 to 1000000000, too many",
        ),
        (spaces.Discrete(3), {"discretizer": int, "shape": ()}, "^shape must hold the number of cells along each axis"),
        (spaces.Box(0, 1, (1,)), {"discretizer": "bins", "bins": 3, "low": (0, 1)}, "^low must hold 1 number for"),
        (spaces.Box(0, 1, (1,)), {"discretizer": "bins", "bins": (3, 4)}, "^bins must hold 1 number for .* got"),
        (spaces.Discrete(10**12), {}, r"2\*\*32 values \(max_rows= .* got Discrete\(1000000000000\)"),
    ],
)
def test_a_space_is_refused_with_what_would_fit(space: Any, settings: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        qtab.train(Still(space), **settings, **SHORT)


@pytest.mark.parametrize(
    ("space", "wrapper"),
    [
        (spaces.Discrete(4), "DtypeObservation(FlattenObservation(env), np.float32)"),
        (spaces.Box(0, 5, (2, 2), np.uint8), "DtypeObservation(FlattenObservation(env), np.float32)"),
        (spaces.Box(0, 5, (2,), np.int64), "DtypeObservation(env, np.float32)"),
        (spaces.Box(0, 5, (2, 2)), "FlattenObservation(env)"),
        (spaces.Dict({"floor": spaces.Discrete(3), "speed": spaces.Box(0, 1, (2,))}), "FlattenObservation(env)"),
    ],
)
def test_weighted_features_name_the_wrappers_with_which_they_work(space: Any, wrapper: str) -> None:
    settings: dict[str, Any] = {"discretizer": "polynomial", "order": 1, "coupled": False, **SHORT}
    env = Still(space)
    with pytest.raises(ValueError, match=re.escape(f"; {wrapper} of gymnasium.wrappers makes one")):
        qtab.train(env, **settings)
    names = {"env": env, "np": np, **{name: getattr(gym.wrappers, name) for name in WRAPPERS}}
    assert qtab.train(eval(wrapper, names), **settings).completed  # noqa: S307 - one of the strings above


@pytest.mark.slow
def test_62_axes_are_served() -> None:
    runs = qtab.train_many(lambda: Still(spaces.MultiDiscrete([1] * 62)), 2, threads=1, tables=True, episodes=2)
    assert runs[1].q_table.ndim == 63
    run = qtab.train(Still(spaces.MultiDiscrete([1] * 62)), **SHORT)
    assert run.q_table.ndim == 63
    assert qtab.verify(run, env=Still(spaces.MultiDiscrete([1] * 62))).equal


def test_a_table_that_takes_too_much_memory_is_named_with_its_space(monkeypatch: pytest.MonkeyPatch) -> None:
    space = spaces.Discrete(10**6)
    message = r"with a table of 1,000,000 rows of 2 actions for Discrete\(1000000\) would take .* max_rows= assigns"
    with pytest.raises(MemoryError, match=message) as caught:
        qtab.train(Still(space, 0), memory_limit=10**6, **SHORT)
    assert "half of" not in str(caught.value)
    monkeypatch.setattr("os.sysconf", lambda _: 1000)
    with pytest.raises(MemoryError, match=r"more than half of the machine's memory \(488 KiB\)"):
        qtab.train(Still(space, 0), **SHORT)
    assert qtab.train(Still(space, 0), max_rows=10, **SHORT).completed
