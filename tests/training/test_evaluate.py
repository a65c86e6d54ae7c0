"""evaluate plays the greedy policy in the environment, as a Python rollout does."""

import math
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.environments import Walk


@pytest.fixture(scope="module")
def learned():
    return qtab.train("MountainCar-v0", seed=0)


def rollout(env, run, episodes, seed):
    """Gymnasium's usual loop with greedy actions, without learning."""
    returns, lengths, ends = [], [], []
    for episode in range(episodes):
        observation, _ = env.reset(seed=seed if episode == 0 else None)
        total, length, terminated, truncated = 0.0, 0, False, False
        while not (terminated or truncated):
            action, _ = run.predict(observation)
            observation, reward, terminated, truncated, _ = env.step(action)
            total += reward
            length += 1
        returns.append(total)
        lengths.append(length)
        ends.append(terminated)
    return returns, lengths, ends


def test_another_time_limit_and_other_keyword_arguments_can_be_given(learned):
    longer = qtab.evaluate(learned, episodes=10, seed=0, max_episode_steps=1000)
    assert longer.lengths.max() > 200
    env = gym.make("MountainCar-v0", goal_velocity=0.05)
    returns, lengths, _ = rollout(env, learned, 10, 0)
    found = qtab.evaluate(learned, episodes=10, seed=0, env_kwargs={"goal_velocity": 0.05})
    assert (found.returns.tolist(), found.lengths.tolist()) == (returns, lengths)


@pytest.mark.parametrize("seed", [0, 17, 2**70])
def test_evaluate_plays_the_greedy_policy_in_gymnasium(learned, seed):
    found = qtab.evaluate(learned, episodes=20, seed=seed)
    returns, lengths, ends = rollout(gym.make("MountainCar-v0"), learned, 20, seed)
    assert found.returns.tolist() == returns
    assert found.lengths.tolist() == lengths
    assert found.terminated.tolist() == ends
    assert any(ends)
    assert found.seed == seed


def test_the_fields_of_an_evaluation_are_computed_as_documented(learned):
    found = qtab.evaluate(learned, episodes=50, seed=1)
    returns = found.returns.tolist()
    mean = sum(returns) / 50
    assert found.mean_return == pytest.approx(mean, rel=1e-12)
    spread = math.sqrt(sum((value - mean) ** 2 for value in returns) / 49)
    assert found.standard_error == pytest.approx(spread / math.sqrt(50), rel=1e-12)
    assert found.terminated_rate == found.terminated.sum() / 50
    assert found.success_rate == sum(value >= -110.0 for value in returns) / 50
    assert found.reward_threshold == -110.0
    assert found.returns.dtype == np.float64
    assert found.lengths.dtype == np.int64


def test_a_return_at_the_threshold_is_a_success(learned):
    found = qtab.evaluate(learned, episodes=60, seed=1)
    at = qtab.Evaluation(found.returns, found.lengths, found.terminated, 1, float(found.returns.max()))
    assert at.success_rate == (found.returns == found.returns.max()).sum() / 60


def test_one_episode_has_no_standard_error(learned):
    assert math.isnan(qtab.evaluate(learned, episodes=1, seed=0).standard_error)


def test_an_environment_without_a_threshold_has_no_success_rate():
    run = qtab.train(Walk(), scale=(2, 2), seed=0, episodes=5, max_episode_steps=30)
    found = qtab.evaluate(run, episodes=5, seed=1, env=Walk())
    assert found.success_rate is None
    assert found.returns.tolist() == rollout(gym.wrappers.TimeLimit(Walk(), 30), run, 5, 1)[0]


def test_evaluation_uses_the_actions_and_time_limit_of_the_run():
    run = qtab.train(Walk(np.float64, start=5), scale=(2, 3), seed=0, episodes=30, max_episode_steps=25)
    found = qtab.evaluate(run, episodes=5, seed=1, env=Walk(np.float64, start=5))
    env = gym.wrappers.TimeLimit(Walk(np.float64, start=5), 25)
    assert (found.returns.tolist(), found.lengths.tolist(), found.terminated.tolist()) == rollout(env, run, 5, 1)


def test_evaluation_uses_the_keyword_arguments_of_the_run():
    never: dict[str, Any] = {"goal_velocity": 0.08}
    run = qtab.train("MountainCar-v0", seed=0, env_kwargs=never, max_episode_steps=300)
    found = qtab.evaluate(run, episodes=5, seed=0)
    assert found.terminated_rate == 0.0
    assert found.success_rate is None  # the threshold is for another task
    assert found.lengths.tolist() == [300] * 5
    assert found.lengths.tolist() == rollout(gym.make("MountainCar-v0", max_episode_steps=300, **never), run, 5, 0)[1]


def test_a_loaded_run_evaluates_like_the_saved_one(learned, tmp_path):
    learned.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert qtab.evaluate(loaded, 9, seed=3).returns.tolist() == qtab.evaluate(learned, 9, seed=3).returns.tolist()


def test_both_backends_evaluate_the_same(learned):
    settings: dict[str, Any] = {"seed": 0, "episodes": 5, "initial_q": learned.q_table}
    fast, slow = (qtab.train("MountainCar-v0", backend=backend, **settings) for backend in ("rust", "gymnasium"))
    returns = qtab.evaluate(fast, 9, seed=3).returns
    assert len(set(returns.tolist())) > 1
    assert returns.tolist() == qtab.evaluate(slow, 9, seed=3).returns.tolist()


def test_evaluation_does_not_change_the_run(learned):
    before = learned.tables.tobytes()
    qtab.evaluate(learned, episodes=5, seed=0)
    assert learned.tables.tobytes() == before


def test_a_seed_that_is_not_given_is_drawn_and_recorded(learned):
    found = qtab.evaluate(learned, episodes=5)
    assert qtab.evaluate(learned, episodes=5, seed=found.seed).returns.tolist() == found.returns.tolist()
    assert found.seed != qtab.evaluate(learned, episodes=5).seed


@pytest.mark.parametrize(
    ("argument", "error"),
    [
        ({"episodes": 0}, ValueError),
        ({"episodes": 1.5}, TypeError),
        ({"seed": -1}, ValueError),
        ({"seed": 1.0}, TypeError),
    ],
)
def test_a_bad_argument_is_refused_by_name(learned, argument, error):
    ((name, value),) = argument.items()
    with pytest.raises(error, match=f"{name} must be .* got {value!r}"):
        qtab.evaluate(learned, **argument)
