"""The description of an environment: it shows each difference, and is enough to make the environment again."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import (
    ClipReward,
    NormalizeObservation,
    RecordEpisodeStatistics,
    RescaleObservation,
    TransformObservation,
    TransformReward,
)

import qtab
from qtab.envs.origin.again import make_again
from qtab.envs.origin.describe import describe
from qtab.envs.origin.description import EnvironmentDescription, differences, from_json
from qtab.envs.registry import ENTRIES, EXTRA

CAR, LAKE = "MountainCar-v0", "FrozenLake-v1"
SLOW_TABLES = ("qtab/JacksCarRental-v0", "qtab/GamblersProblem-v0")


class Reversed(gym.Wrapper[Any, Any, Any, Any]):
    """A wrapper with nothing but the environment."""

    def step(self, action: Any) -> Any:
        return self.env.step(2 - action)


class Padded(gym.Wrapper[Any, Any, Any, Any]):
    """A wrapper that does not record its arguments."""

    def __init__(self, env: gym.Env, amount: float) -> None:
        super().__init__(env)
        self._amount = amount


class Doubled(gym.RewardWrapper[Any, Any]):
    """A wrapper that changes one of its attributes, and not the other."""

    def __init__(self, env: gym.Env) -> None:
        super().__init__(env)
        self.factor, self.steps = 2, 0

    def reward(self, reward: Any) -> float:
        self.steps += 1
        return self.factor * float(reward)


class Tenth(TransformReward[Any, Any]):
    """A subclass whose arguments are not those that its base class records."""

    def __init__(self, env: gym.Env) -> None:
        super().__init__(env, lambda reward: float(reward) / 10)


class Clipped(ClipReward[Any, Any]):
    """Another one, with an argument."""

    def __init__(self, env: gym.Env, most: float) -> None:
        super().__init__(env, -most, most)


class Corridor(gym.Env[Any, Any]):
    """An environment without an id."""

    observation_space = gym.spaces.Discrete(3)
    action_space = gym.spaces.Discrete(2)

    def __init__(self, penalty: float = -1.0) -> None:
        self.penalty = penalty


def car(**kwargs: Any) -> Any:
    return gym.make(CAR, **kwargs)


def changed(env: Any, **attributes: Any) -> Any:
    for name, value in attributes.items():
        setattr(env.unwrapped, name, value)
    return env


def changed_layer(env: Any, **attributes: Any) -> Any:
    vars(env).update(attributes)
    return env


def lake_with_rewards() -> Any:
    env: Any = gym.make(LAKE)
    for actions in env.unwrapped.P.values():
        for action, outcomes in actions.items():
            actions[action] = [(p, state, 10 * reward, end) for p, state, reward, end in outcomes]
    return env


def other_space(env: Any) -> Any:
    return TransformObservation(env, np.array, gym.spaces.Box(-2.0, 2.0, (2,), np.float32))


DIFFERENT: dict[str, tuple[Callable[[], Any], Callable[[], Any], str]] = {
    "id": (car, lambda: gym.make("CartPole-v1"), "it was MountainCar-v0, and is now CartPole-v1"),
    "argument": (
        car,
        lambda: car(goal_velocity=0.1),
        "its argument goal_velocity was not given, and is now 0.1",
    ),
    "attribute": (car, lambda: changed(car(), force=0.01), "its attribute force was 0.001, and is now 0.01"),
    "method": (car, lambda: changed(car(), step=lambda action: None), "its attribute step was as the constructor"),
    "table": (lambda: gym.make(LAKE), lake_with_rewards, "its transition table has changed"),
    "wrapper": (
        lambda: RescaleObservation(car(), np.float32(0), np.float32(1)),
        car,
        "it was in the wrapper RescaleObservation, and is now without a wrapper",
    ),
    "argument of a wrapper": (
        lambda: ClipReward(car(), -1.0, 0.0),
        lambda: ClipReward(car(), -2.0, 0.0),
        "of the wrapper ClipReward, the argument min_reward was -1.0, and is now -2.0",
    ),
    "function of a wrapper": (
        lambda: TransformReward(car(), lambda reward: 2 * float(reward)),
        lambda: TransformReward(car(), lambda reward: 3 * float(reward)),
        "the argument func was the function",
    ),
    "attribute of a wrapper": (
        lambda: Padded(car(), 1.0),
        lambda: Padded(car(), 2.0),
        "of the wrapper Padded, the attribute amount was 1.0, and is now 2.0",
    ),
    "attribute of a wrapper without arguments": (
        lambda: Doubled(car()),
        lambda: changed_layer(Doubled(car()), factor=5),
        "of the wrapper Doubled, the attribute factor was 2, and is now 5",
    ),
    "attribute of Taxi": (
        lambda: gym.make("Taxi-v4"),
        lambda: changed(gym.make("Taxi-v4"), fickle_passenger=True),
        "its attribute fickle_passenger was as the constructor leaves it, and is now True",
    ),
    "bounds": (
        lambda: other_space(car()),
        lambda: TransformObservation(car(), np.array, gym.spaces.Box(-3.0, 2.0, (2,), np.float32)),
        "its observation_space was Box(-2.0, 2.0, (2,), float32), and is now Box(",
    ),
    "order of a MultiDiscrete": (
        lambda: changed(Corridor(), observation_space=gym.spaces.MultiDiscrete([4, 6])),
        lambda: changed(Corridor(), observation_space=gym.spaces.MultiDiscrete([6, 4])),
        "its observation_space was MultiDiscrete([4 6]), and is now MultiDiscrete([6 4])",
    ),
    "constructor of a class without an id": (
        Corridor,
        lambda: Corridor(-7.0),
        "its attribute penalty was -1.0, and is now -7.0",
    ),
    "transitions of a class without an id": (
        lambda: qtab.TabularEnv([[[(1.0, 0, -1.0, True)]]], [1.0]),
        lambda: qtab.TabularEnv([[[(1.0, 0, -7.0, True)]]], [1.0]),
        "its transition table has changed",
    ),
}


@pytest.mark.parametrize("what", DIFFERENT)
def test_each_difference_is_named(what: str) -> None:
    one, other, sentence = DIFFERENT[what]
    assert differences(describe(one()), describe(one())) == []
    for ours, theirs in ((describe(one()), describe(other())), (stored(describe(one())), stored(describe(other())))):
        assert sentence in "; ".join(differences(ours, theirs))


def stored(description: EnvironmentDescription) -> EnvironmentDescription:
    return from_json(json.loads(json.dumps(description.as_json(), allow_nan=False)))


def test_a_function_that_is_written_again_is_the_same() -> None:
    one = describe(TransformReward(car(), lambda reward: 2 * float(reward)))
    assert differences(one, describe(TransformReward(car(), lambda reward: 2 * float(reward)))) == []


@pytest.mark.parametrize("name", [name for name in (*ENTRIES, *EXTRA) if name not in SLOW_TABLES])
@pytest.mark.filterwarnings("ignore:.*out of date")
def test_a_used_environment_is_described_as_a_new_one(name: str) -> None:
    env = gym.make(name)
    expected = describe(env, is_new=True)
    env.reset(seed=3)
    env.action_space.seed(3)
    for _ in range(20):
        _, _, terminated, truncated, _ = env.step(env.action_space.sample())
        if terminated or truncated:
            env.reset()
    assert differences(expected, describe(env)) == []
    assert differences(describe(env), expected) == []


def test_wrappers_that_only_look_on_do_not_count() -> None:
    assert differences(describe(RecordEpisodeStatistics(car())), describe(car().unwrapped)) == []


def made_from_spec(env: Any) -> Any:
    return gym.make(env.spec)


AGAIN: dict[str, Callable[[], Any]] = {
    "plain": car,
    "arguments": lambda: car(goal_velocity=0.02),
    "attribute": lambda: changed(car(), gravity=0.0015),
    "wrappers": lambda: ClipReward(RescaleObservation(changed(car(), force=0.002), np.float32(0), np.float32(1)), -2.0),
    "own wrapper": lambda: Reversed(car()),
    "own wrapper that changes an attribute": lambda: Doubled(car()),
    "subclass with other arguments": lambda: Tenth(car()),
    "qtab's twin": lambda: RescaleObservation(gym.make(f"qtab/{CAR}"), np.float32(0), np.float32(1)),
    "spec with wrappers": lambda: made_from_spec(RescaleObservation(car(), np.float32(0), np.float32(1))),
}


@pytest.mark.parametrize("what", AGAIN)
def test_an_environment_is_made_again_as_it_was(what: str) -> None:
    env = AGAIN[what]()
    description = stored(describe(env))
    again = make_again(description, gym.spec(env.spec.id), env.unwrapped.spec.kwargs, 200)
    assert differences(description, describe(again)) == []
    for one in (env, again):
        one.reset(seed=5)
    for action in (0, 2, 1, 2):
        mine, theirs = env.step(action), again.step(action)
        assert mine[0].tobytes() == theirs[0].tobytes()
        assert mine[1:4] == theirs[1:4]


def test_what_cannot_be_made_again_is_named() -> None:
    class Local(Reversed):
        pass

    found = {
        "the arguments of its wrapper Padded are not known": Padded(car(), 1.0),
        "the arguments of its wrapper Clipped are not known": Clipped(car(), 1.0),
        "its wrapper NormalizeObservation keeps running statistics": NormalizeObservation(car()),
        "its wrapper TransformReward was made with the function": TransformReward(car(), lambda reward: reward),
        "<locals>.Local is not a class of an imported module": Local(car()),
        "its attribute step was the function": changed(car(), step=lambda action: None),
    }
    for reason, env in found.items():
        with pytest.raises(ValueError, match=f"^env must be given: the environment {CAR} cannot be made") as caught:
            make_again(describe(env), gym.spec(CAR), {}, 200)
        assert reason in str(caught.value)
    with pytest.raises(ValueError, match=r"its constructor makes another transition table$"):
        make_again(describe(lake_with_rewards()), gym.spec(LAKE), {}, 200)


def test_a_description_from_a_file_imports_nothing_and_calls_no_class_but_a_wrapper() -> None:
    description = describe(Reversed(car()))
    for cls in ("antigravity:Wrapper", "os:system", "builtins:int", "gymnasium.wrappers:np.array"):
        wrapper = description.wrappers[0].__class__(cls, None, {}, {})
        hostile = from_json({**description.as_json(), "wrappers": [wrapper.__dict__]})
        with pytest.raises(ValueError, match="is not a class of an imported module"):
            make_again(hostile, gym.spec(CAR), {}, 200)
    for name in ("__class__", "step", "no_such_attribute"):
        with pytest.raises(ValueError, match=f"its attribute {name} was 3"):
            make_again(from_json({**describe(car()).as_json(), "attributes": {name: 3}}), gym.spec(CAR), {}, 200)


def test_a_description_from_a_file_writes_no_files(tmp_path: Path) -> None:
    description = describe(Reversed(car()))
    kwargs = {"video_folder": str(tmp_path / "videos")}
    wrapper = description.wrappers[0].__class__("gymnasium.wrappers:RecordVideo", None, kwargs, {})
    hostile = from_json({**description.as_json(), "wrappers": [wrapper.__dict__]})
    with pytest.raises(ValueError, match="RecordVideo is not one that a run stores"):
        make_again(hostile, gym.spec(CAR), {"render_mode": "rgb_array"}, 200)
    assert not (tmp_path / "videos").exists()
