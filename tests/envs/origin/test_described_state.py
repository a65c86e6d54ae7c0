"""What an environment changes by itself is its state: its description leaves it out, and keeps everything else."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.config.origin import trained_on
from qtab.envs.origin.class_code import class_code
from qtab.envs.origin.describe import describe
from qtab.envs.origin.description import differences
from qtab.envs.origin.values import describe_value, with_types

LAKE = "FrozenLake-v1"


class Counting(gym.Env[Any, Any]):
    """An environment that counts, in attributes, in a list and in an array, what its episodes do."""

    def __init__(self, position: int = 0, size: int = 60, penalty: float = 1.0) -> None:
        self.observation_space, self.action_space = gym.spaces.Discrete(size), gym.spaces.Discrete(2)
        self.position, self.size, self.penalty = position, size, penalty
        self.goals, self.visits, self.starts = 0, np.zeros(size), [0]
        self.wind = 0

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.position = 0
        self.starts.append(0)
        return 0, {}

    def step(self, action: Any) -> Any:
        self.position = min(self.position + 1, self.size - 1) if action else max(self.position - 1, 0)
        self.visits[self.position] += 1
        done = self.position == self.size - 1
        if done:
            self._count()
        return self.position, -self.penalty, done, False, {}

    def _count(self) -> None:
        self.goals += 1


@pytest.fixture
def counting() -> Any:
    gym.register("Counting-v0", lambda **kwargs: Counting(**kwargs), max_episode_steps=80)
    yield lambda: gym.make("Counting-v0")
    del gym.registry["Counting-v0"]


def play(env: Any) -> None:
    env.reset(seed=0)
    done = False
    while not done:
        _, _, done, _, _ = env.step(1)


@pytest.mark.parametrize("registered", [False, True])
def test_an_environment_that_counts_its_episodes_can_be_trained_on_again(counting: Any, registered: bool) -> None:
    env = counting() if registered else Counting()
    run = qtab.train(env, episodes=3, seed=0, max_episode_steps=80)
    play(env)
    assert len(qtab.resume(run, env=env, episodes=4).episode_returns) == 4
    assert qtab.verify(run, env=env, episodes=2)


def test_attributes_that_no_step_changes_are_kept(counting: Any) -> None:
    env = counting()
    env.unwrapped.wind = 3
    play(env)
    description = describe(env)
    assert description.attributes["wind"] == 3
    assert not description.attributes.keys() & {"position", "goals", "visits", "starts"}
    assert "its attribute wind was 3, and is now" in differences(description, describe(counting()))[0]


PS: dict[str, Callable[[], Any]] = {
    "number": lambda: 0.3,
    "array": lambda: np.ones((2, 2, 4)),
    "function": lambda: lambda state: state,
    "transitions that are not numbers": lambda: {0: {0: [("half", 0, 1.0, True)]}},
}


@pytest.mark.parametrize("kind", PS)
@pytest.mark.parametrize("registered", [False, True])
def test_an_attribute_named_p_need_not_be_a_table(counting: Any, kind: str, registered: bool) -> None:
    env: Any = counting() if registered else Counting()
    env.unwrapped.P = PS[kind]()
    run = qtab.train(env, episodes=2, seed=0, max_episode_steps=80)
    assert differences(describe(env), describe(env)) == []
    assert len(qtab.evaluate(run, episodes=1, env=env).returns) == 1


def test_a_map_that_a_constructor_draws_is_not_replaced_by_another() -> None:
    run = qtab.train(LAKE, env_kwargs={"map_name": None}, episodes=2, seed=0)
    with pytest.raises(ValueError, match=r"its constructor makes another transition table$"):
        qtab.evaluate(run, episodes=1)


def test_a_changed_attribute_of_taxi_comes_with_the_run() -> None:
    env: Any = gym.make("Taxi-v4")
    env.unwrapped.fickle_passenger = True
    run = qtab.train(env, episodes=5, seed=0)
    description = trained_on(run.config)
    assert description is not None
    assert description.attributes == {"fickle_passenger": True}
    again = qtab.train(config=run.config)
    assert again.q_table.tobytes() == run.q_table.tobytes()
    assert qtab.train("Taxi-v4", episodes=5, seed=0).q_table.tobytes() != run.q_table.tobytes()


def test_the_code_of_a_class_does_not_depend_on_addresses() -> None:
    def made() -> type:
        class Tools:
            tools = (object(), [object()], frozenset("abc"))

            def use(self) -> Any:
                return self.tools

        return Tools

    assert class_code(made()) == class_code(made())


@pytest.mark.parametrize(
    "values", [(np.array([1.0, 2.0]), np.array([1.0, 3.0])), (np.int8(1), np.int8(2)), ({}, {1: 2})]
)
def test_functions_that_close_over_other_values_differ(values: tuple[Any, Any]) -> None:
    def described(value: Any) -> Any:
        return describe(gym.wrappers.TransformReward(Counting(), lambda reward: (value, reward)[1]))

    one, other = map(described, values)
    assert differences(one, described(values[0])) == []
    assert "the argument func was the function" in differences(one, other)[0]


@pytest.mark.parametrize("by_id", [False, True])
def test_a_run_file_keeps_the_types_of_arguments(tmp_path: Path, by_id: bool) -> None:
    kwargs = {"reward_schedule": (1, -1, 0)}
    env = LAKE if by_id else gym.make(LAKE, **kwargs)  # type: ignore[arg-type]
    run = qtab.train(env, env_kwargs=kwargs if by_id else {}, episodes=3, seed=0)
    path = tmp_path / "run.npz"
    run.save(path)
    loaded = qtab.load(path)
    assert loaded.config == run.config
    assert loaded.config.env_kwargs["reward_schedule"] == (1, -1, 0)
    assert qtab.evaluate(loaded, episodes=2, seed=1).mean_return == qtab.evaluate(run, episodes=2, seed=1).mean_return
    assert qtab.train(config=loaded.config).q_table.tobytes() == run.q_table.tobytes()
    assert qtab.resume(loaded, env=gym.make(LAKE, **kwargs), episodes=4)  # type: ignore[arg-type]


def test_arguments_with_which_a_description_disagrees_stay() -> None:
    described = {"same": describe_value((1, 2)), "other": describe_value((1, 3)), "unknown": describe_value(object())}
    stored = {"same": [1, 2], "other": [1, 2], "unknown": 3, "not described": [1]}
    assert with_types(stored, described) == {**stored, "same": (1, 2)}
