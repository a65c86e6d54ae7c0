"""An exception in an environment is raised unchanged, and carries the run so far."""

import re
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.environments import Calls, ScriptedEnv
from support.parity import assert_same_run, run_of

ONE = np.array([1.0], np.float32)


class BrokenError(Exception):
    """Raised by the tests' environments."""


def raising_at(step, error):
    def fail(count):
        if count == step:
            raise error

    return fail


def train(env, **settings):
    chosen: dict[str, Any] = {"scale": (1,), "seed": 0, "episodes": 5} | settings
    return qtab.train(env, **chosen)


@pytest.mark.parametrize(
    "error", [BrokenError("axle"), KeyboardInterrupt(), SystemExit(1), StopIteration(), OSError(5, "x")]
)
def test_an_exception_during_an_episode_carries_the_finished_episodes(error):
    with pytest.raises(type(error)) as caught:
        train(Calls(ScriptedEnv([ONE]), raising_at(2 * 8 + 3, error)))
    assert caught.value is error
    run = error.run
    assert run.completed is False
    assert run.episode_lengths.tolist() == [8, 8]
    whole = train(ScriptedEnv([ONE]))
    assert run.episode_returns.tobytes() == whole.episode_returns[:2].tobytes()
    assert run.config.episodes == 5


def test_what_was_learned_in_the_unfinished_episode_is_kept():
    runs = []
    for step in (8, 8 + 5):
        error = BrokenError()
        with pytest.raises(BrokenError):
            train(Calls(ScriptedEnv([ONE]), raising_at(step, error)))
        runs.append(run_of(error))
    assert runs[0].episode_lengths.tolist() == runs[1].episode_lengths.tolist() == [8]
    assert runs[0].tables.tobytes() != runs[1].tables.tobytes()


@pytest.mark.parametrize("at", [0, 3])
def test_an_exception_in_a_reset_carries_the_run(at):
    error = BrokenError("no start")

    class NoStart(ScriptedEnv):
        def reset(self, **kwargs):
            if len(self.seeds) == at:
                raise error
            return super().reset(**kwargs)

    with pytest.raises(BrokenError) as caught:
        train(NoStart([ONE]))
    assert caught.value is error
    assert len(run_of(error).episode_returns) == at


def test_an_exception_with_an_attribute_run_is_left_unchanged():
    class OwnRunError(Exception):
        @property
        def run(self):
            return 7

    error = OwnRunError()
    with pytest.raises(OwnRunError) as caught:
        train(Calls(ScriptedEnv([ONE]), raising_at(3, error)))
    assert caught.value is error
    assert error.run == 7


def test_the_traceback_shows_the_environment():
    with pytest.raises(BrokenError) as caught:
        train(Calls(ScriptedEnv([ONE]), raising_at(3, BrokenError())))
    assert any(entry.name == "fail" for entry in caught.traceback)


@pytest.mark.parametrize("reward", [float("nan"), float("inf"), float("-inf"), np.float32("nan")])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_reward_that_is_not_finite_is_refused(dtype, reward):
    with pytest.raises(ValueError, match=r"must return a finite number as the reward.* got .*(nan|-?inf)") as caught:
        train(ScriptedEnv([ONE.astype(dtype)], dtype=dtype, rewards=[-1.0] * 20 + [reward]))
    assert run_of(caught.value).episode_lengths.tolist() == [8, 8]
    assert np.isfinite(run_of(caught.value).tables).all()


REWARD = r"^step of <ScriptedEnv instance> must return a finite number as the reward, as Gymnasium's API requires, got "


@pytest.mark.parametrize("reward", [None, "1", b"1", 1j, [1.0], np.ones(2)])
def test_a_reward_that_is_not_a_number_is_refused(reward):
    with pytest.raises(TypeError, match=REWARD + re.escape(repr(reward))) as caught:
        train(ScriptedEnv([ONE], rewards=[-1.0] * 20 + [reward]))
    assert run_of(caught.value).episode_lengths.tolist() == [8, 8]


def test_a_reward_beyond_the_range_of_floats_is_refused():
    with pytest.raises(ValueError, match=REWARD + "1000"):
        train(ScriptedEnv([ONE], rewards=[10**400]))


class Answering(ScriptedEnv):
    """Returns the given values instead of the right ones; None stands for a right one."""

    def __init__(self, step=None, reset=None):
        super().__init__([ONE])
        self.answers = step, reset

    def step(self, action):
        right: Any = super().step(action)
        return self.answers[0](right) if self.answers[0] else right

    def reset(self, **kwargs):
        right: Any = super().reset(**kwargs)
        return self.answers[1](right) if self.answers[1] else right


@pytest.mark.parametrize("flag", ["no", None, 2, 1.0, [], b""])
@pytest.mark.parametrize(("place", "name"), [(2, "terminated"), (3, "truncated")])
def test_a_flag_that_is_no_bool_is_refused(flag, place, name):
    env = Answering(step=lambda right: (*right[:place], flag, *right[place + 1 :]))
    with pytest.raises(
        TypeError, match=rf"^step of <Answering instance> must return a bool as {name}, .* got "
    ) as caught:
        train(env)
    assert run_of(caught.value).completed is False


@pytest.mark.parametrize("kind", [bool, np.bool_, int, np.int64, np.array])
def test_flags_of_these_types_are_taken(kind):
    env = Answering(step=lambda right: (*right[:2], kind(right[2]), kind(right[3]), right[4]))
    assert_same_run(train(env), train(ScriptedEnv([ONE])))


@pytest.mark.parametrize(
    ("answer", "error", "got"),
    [
        (5, TypeError, r"a tuple \(observation, info\), .* got 5"),
        (ONE, TypeError, r"a tuple \(observation, info\), .* got array"),
        ((ONE, {}, 1), ValueError, r"a tuple \(observation, info\), .* got a tuple of 3"),
        ((ONE, ONE), TypeError, "a dict as the info, .* got array"),
    ],
)
def test_a_reset_that_returns_something_else_is_refused(answer, error, got):
    with pytest.raises(error, match=rf"^reset of <Answering instance> must return {got}") as caught:
        train(Answering(reset=lambda right: answer))
    assert run_of(caught.value).completed is False


@pytest.mark.parametrize(
    ("observation", "shape"),
    [(np.ones(2, np.float32), r"\(2,\)"), (np.ones((1, 1), np.float32), r"\(1, 1\)"), (1.0, r"\(\)"), ([], r"\(0,\)")],
)
def test_an_observation_of_another_shape_is_refused_with_its_shape(observation, shape):
    with pytest.raises(ValueError, match=rf"observation must have shape \(1,\).* got {shape}$"):
        train(ScriptedEnv([ONE, ONE, observation]))


@pytest.mark.parametrize("observation", ["left", {"x": 1.0}, object()])
def test_an_observation_without_numbers_is_refused(observation):
    with pytest.raises((TypeError, ValueError)):
        train(ScriptedEnv([ONE, observation]))


def test_a_step_of_four_values_is_refused():
    class Old(ScriptedEnv):
        def step(self, action):
            return super().step(action)[:4]

    with pytest.raises(
        ValueError, match=r"^step of <Old instance> must return a tuple \(observation, reward, .* got a tuple of 4: "
    ):
        train(Old([ONE]))


class Nested(gym.Env):
    """Its observations leave their space, or its step fails."""

    observation_space = gym.spaces.Dict({"gear": gym.spaces.Discrete(3), "side": gym.spaces.Discrete(2)})
    action_space = gym.spaces.Discrete(2)

    def __init__(self, error: Exception | None) -> None:
        self.error = error

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return {"gear": 1, "side": 0}, {}

    def step(self, action):
        if self.error is not None:
            raise self.error
        return {"gear": 7, "side": 0}, 0.0, False, False, {}


def test_only_the_extensions_messages_are_put_in_terms_of_the_space():
    with pytest.raises(ValueError, match=r"^observation\['gear'\] is 7,"):
        qtab.train(Nested(None), seed=0, episodes=3)
    arguments = "observation[0] is 7, says the motor", 5
    error = ValueError(*arguments)
    with pytest.raises(ValueError, match="says the motor") as caught:
        qtab.train(Nested(error), seed=0, episodes=3)
    assert caught.value is error
    assert error.args == arguments
    assert run_of(error).completed is False


@pytest.mark.parametrize("argument", [{"reason": "motor"}, 3, None])
def test_the_arguments_of_an_environments_error_stay_what_they_are(argument):
    error = ValueError(argument)
    with pytest.raises(ValueError) as caught:
        qtab.train(Nested(error), seed=0, episodes=3)
    assert caught.value.args == (argument,)


def test_an_environment_can_be_trained_on_again_after_it_failed():
    env = Calls(ScriptedEnv([ONE]), raising_at(3, BrokenError()))
    with pytest.raises(BrokenError):
        train(env)
    assert_same_run(train(env), train(ScriptedEnv([ONE])))


def test_an_environment_may_train_inside_its_step():
    inner = []

    def train_inside(count):
        if count == 3:
            inner.append(train(ScriptedEnv([ONE])))

    outer = train(Calls(ScriptedEnv([ONE]), train_inside))
    assert_same_run(outer, inner[0])


def test_an_assertion_of_gymnasiums_wrappers_is_raised():
    env: Any = gym.wrappers.OrderEnforcing(ScriptedEnv([ONE]))
    env.reset = lambda **kwargs: (ONE, {})
    with pytest.raises(gym.error.ResetNeeded) as caught:
        train(env)
    assert run_of(caught.value).completed is False
