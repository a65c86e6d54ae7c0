"""Discrete actions of a continuous space: what the environment gets, and what training makes of it."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.rendering.replay import replay_episode
from support.environments import ScriptedEnv
from support.parity import assert_same_run

BINS: dict[str, Any] = {"discretizer": "bins", "bins": 6}


class Push(gym.Env[Any, Any]):
    """A point in a box, pushed by its action; it writes to the action that it gets."""

    def __init__(self, space: gym.spaces.Box) -> None:
        self.action_space = space
        self.observation_space = gym.spaces.Box(-1.0, 1.0, (2,), np.float64)
        self.taken: list[Any] = []

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.place = self.np_random.uniform(-0.5, 0.5, 2)
        return self.place.copy(), {}

    def step(self, action: Any) -> Any:
        self.taken.append(action.copy())
        action *= 0.3
        self.place = np.clip(self.place + float(action.sum()) + self.np_random.uniform(-0.1, 0.1, 2), -1.0, 1.0)
        return self.place.copy(), -float(abs(self.place).sum()), bool(abs(self.place[0]) > 0.9), False, {}


def handed(space: gym.spaces.Box, actions: Any) -> tuple[list[Any], qtab.Run]:
    """The different actions that an environment of that space gets, and the run."""
    env = Push(space)
    run = qtab.train(env, actions=actions, episodes=30, seed=0, epsilon=1.0, max_episode_steps=40, **BINS)
    assert all(type(action) is np.ndarray and action.dtype == space.dtype for action in env.taken)
    assert qtab.verify(run, env=Push(space)).equal
    return sorted({tuple(action.tolist()) for action in env.taken}), run


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_number_of_actions_means_numpys_linspace_in_the_dtype_of_the_space(dtype: Any) -> None:
    space = gym.spaces.Box(-1.0, 0.7, (1,), dtype)
    actions, run = handed(space, 7)
    assert actions == [(value,) for value in np.linspace(space.low[0], space.high[0], 7, dtype=dtype).tolist()]
    assert run.q_table.shape == (6, 6, 7)
    assert run.policy.shape == (6, 6, 1)


def test_several_components_make_a_grid_in_c_order() -> None:
    space = gym.spaces.Box(np.array([-1.0, 0.0]), np.array([1.0, 0.5]), dtype=np.float64)
    actions, run = handed(space, 3)
    assert actions == [(x, y) for x in (-1.0, 0.0, 1.0) for y in (0.0, 0.25, 0.5)]
    assert [tuple(run.actions[index]) for index in range(len(run.actions))] == actions


def test_listed_actions_are_used_unchanged() -> None:
    one = gym.spaces.Box(-1.0, 1.0, (1,), np.float32)
    assert handed(one, (-0.3, 0.9))[0] == [(float(np.float32(-0.3)),), (float(np.float32(0.9)),)]
    assert handed(one, [[0.5], [0.25]])[0] == [(0.25,), (0.5,)]
    two = gym.spaces.Box(-1.0, 1.0, (2,), np.float64)
    assert handed(two, ((0.0, 1.0), (-0.5, 0.1)))[0] == [(-0.5, 0.1), (0.0, 1.0)]


@pytest.mark.parametrize(
    ("space", "actions", "error"),
    [
        (
            gym.spaces.Discrete(2),
            3,
            r"^actions applies to Box action spaces only, and this one is Discrete\(2\)",
        ),
        (
            gym.spaces.Box(-1, 1, (1,)),
            None,
            r"^actions must be given for the action space Box\(-1.0, 1.0, \(1,\), float32",
        ),
        (gym.spaces.Box(-1, 1, (1,)), 1, r"^actions must be an integer from 2 to 65536, got 1"),
        (gym.spaces.Box(-1, 1, (1,)), 2.5, r"^actions must be an integer, or hold the actions themselves, got 2.5"),
        (gym.spaces.Box(-1, 1, (1,)), True, r"^actions must be an integer from 2 to 65536, got True"),
        (gym.spaces.Box(-1, 1, (1,)), "all", r"^actions must be an integer, or hold the actions themselves"),
        (gym.spaces.Box(-1, 1, (1,)), (), r"^actions must hold at least one action"),
        (gym.spaces.Box(-1, 1, (1,)), (0.0, 1.5), r"^actions must lie in the action space Box.*got \(0.0, 1.5\)"),
        (gym.spaces.Box(-1, 1, (1,)), (0.0, float("nan")), r"^actions must be finite, got nan"),
        (gym.spaces.Box(-1, 1, (1,)), ("left",), r"^actions must be a finite number, got 'left'"),
        (gym.spaces.Box(-1, 1, (1,)), ((0.0, 1.0),), r"^actions must hold 1 number each for this action space"),
        (gym.spaces.Box(-1, 1, (2,)), (0.0, 1.0), r"^actions must hold 2 numbers each for this action space"),
        (gym.spaces.Box(-np.inf, np.inf, (1,)), 3, r"^actions must be the actions themselves .*no finite bounds"),
        (gym.spaces.Box(-1, 1, (20,)), 3, r"^actions must give at most 65536 actions, got 3 along each of 20"),
        (
            gym.spaces.Box(0, 9, (1,), np.int64),
            3,
            r"^actions must give integers for the action space Box.*, got 3 along",
        ),
        (gym.spaces.Box(0, 9, (1,), np.int64), (0, 2.5), r"^actions must hold integers for the action space Box"),
        (gym.spaces.Box(0, 9, (2,), np.int64), ((0, 10),), r"^actions must lie in the action space Box"),
    ],
    ids=str,
)
def test_settings_that_do_not_fit_are_refused(space: Any, actions: Any, error: str) -> None:
    with pytest.raises((TypeError, ValueError), match=error):
        qtab.train(ScriptedEnv([np.zeros(1, np.float32)], actions=space), actions=actions, **BINS)


@pytest.mark.parametrize("env", ["Pendulum-v1", "MountainCarContinuous-v0"])
def test_a_run_predicts_and_is_saved_evaluated_replayed_and_verified(env: str, tmp_path: Any) -> None:
    run = qtab.train(env, seed=2, episodes=4, actions=(-0.9, 0.0, 0.4), record=2, **BINS)
    space = gym.make(env).action_space
    made = gym.make(env)
    observation, _ = made.reset(seed=0)
    action, _ = run.predict(observation)
    assert made.action_space.contains(action)
    assert action.tobytes() in {np.array([value], np.float32).tobytes() for value in (-0.9, 0.0, 0.4)}
    action[:] = 7.0
    assert space.contains(run.predict(observation)[0])
    assert run.policy[run.discretizer.cell(observation)].tolist() == run.predict(observation)[0].tolist()
    for recording in run.recordings:
        assert all(space.contains(step) for step in recording.actions)
        assert replay_episode(made.unwrapped, recording) != 0.0
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.predict(observation)[0].tobytes() == run.predict(observation)[0].tobytes()
    assert vars(loaded.config) == vars(run.config)
    assert qtab.verify(loaded).equal
    assert qtab.evaluate(loaded, episodes=2, seed=0).returns.shape == (2,)


def test_recorded_episodes_can_be_replayed() -> None:
    from qtab.rendering.replay import make_render_env, replay_all

    run = qtab.train("Pendulum-v1", seed=2, episodes=5, actions=3, record=3, **BINS)
    env = make_render_env(run.config, "rgb_array")
    assert replay_all(env, run, progress=False) == 0
    env.close()


def test_stepping_an_object_equals_stepping_in_rust() -> None:
    settings: dict[str, Any] = {"seed": 5, "episodes": 4, "actions": (-2, 0.3, 1.7), **BINS}
    rust = qtab.train("Pendulum-v1", **settings)
    assert rust.config.backend == "rust"
    assert_same_run(rust, qtab.train(gym.make("Pendulum-v1"), **settings))
    assert_same_run(rust, qtab.train(gym.make("Pendulum-v1"), backend="rust", **settings))


def test_float64_actions_are_stepped_in_python() -> None:
    env = gym.make("Pendulum-v1")
    env.unwrapped.action_space = gym.spaces.Box(-2.0, 2.0, (1,), np.float64)
    with pytest.raises(ValueError, match=r"got 'rust': its action_space was changed from .*float32.* to .*float64"):
        qtab.train(env, backend="rust", actions=3, **BINS)
    double = qtab.train(env, actions=(-2, 0.3, 1.7), seed=5, episodes=4, **BINS)
    assert qtab.verify(double, env=env).equal
    single = qtab.train("Pendulum-v1", actions=(-2, 0.3, 1.7), seed=5, episodes=4, **BINS)
    assert single.episode_returns.tolist() != double.episode_returns.tolist()
