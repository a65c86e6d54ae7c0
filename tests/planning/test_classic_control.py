"""The best known policies of CartPole, Pendulum and Acrobot, replayed in Gymnasium's own environments."""

import functools
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab

LEAST = {"CartPole-v1": 500.0, "Pendulum-v1": -138.0, "Acrobot-v1": -63.0}
"""What the searches return at least."""


@functools.cache
def found(env: str) -> qtab.Optimum:
    return qtab.optimum(env)


def played(best: qtab.Optimum, env: gym.Env, state: Any, max_steps: int) -> float:
    """The return of ``predict`` from a state, in Gymnasium's environment."""
    env.reset()
    inner: Any = env.unwrapped
    inner.state = np.array(state)
    observation = inner._get_ob() if hasattr(inner, "_get_ob") else inner.state
    if hasattr(inner, "_get_obs"):
        observation = inner._get_obs()
    total = 0.0
    for _ in range(max_steps):
        action, _ = best.predict(np.asarray(observation, np.float32))
        observation, reward, terminated, _, _ = inner.step(action)
        total += float(reward)
        if terminated:
            break
    return total


@pytest.mark.slow
@pytest.mark.parametrize("env", LEAST)
def test_the_policy_returns_in_gymnasium_what_the_optimum_says(env: str) -> None:
    best = found(env)
    search: Any = best.search
    assert (best.method, best.exact, best.label) == ("search", False, "best known")
    assert best.expected_return == search.returns.mean() >= search.predict_return
    assert best.expected_return >= LEAST[env]
    theirs = gym.make(env, disable_env_checker=True)
    chosen = range(0, len(search.starts), len(search.starts) // (10 if env == "Acrobot-v1" else 5))
    returns = [played(best, theirs, search.starts[index], best.max_episode_steps) for index in chosen]
    if env == "Acrobot-v1":  # the episodes of the search are routes, which are shorter than the policy's
        assert np.mean(returns) == pytest.approx(search.predict_return, abs=4)
    else:
        assert returns == pytest.approx(search.returns[list(chosen)], abs=0.02)


@pytest.mark.slow
def test_every_route_of_the_acrobot_reaches_the_goal_in_gymnasium_with_its_last_action() -> None:
    search: Any = found("Acrobot-v1").search
    env = gym.make("Acrobot-v1", disable_env_checker=True)
    env.reset()
    inner: Any = env.unwrapped
    for start, steps, total, route in zip(search.starts, search.steps, search.returns, search.routes, strict=True):
        inner.state = start
        ended = [bool(inner.step(int(action))[2]) for action in route]
        assert ended == [False] * (steps - 1) + [True]
        assert total == 1 - steps


@pytest.mark.slow
def test_no_policy_of_cart_pole_returns_more() -> None:
    best = found("CartPole-v1")
    search: Any = best.search
    assert (search.returns == best.max_episode_steps).all()
    assert best.q_values.shape == (*best.values.shape, 2) == (*map(len, search.axes), 2)
    run = qtab.train("CartPole-v1", seed=0, episodes=300)
    assert 0 < best.gap(run).greedy < 500


@pytest.mark.slow
def test_the_pendulum_is_given_a_torque() -> None:
    best = found("Pendulum-v1")
    torque, state = best.predict([1.0, 0.0, 0.0])
    assert (torque.shape, torque.dtype, state) == ((1,), np.float32, None)
    assert gym.make("Pendulum-v1").action_space.contains(torque)
    assert abs(float(torque[0])) < 1e-6  # upright and at rest
    assert best.values.max() <= 0
    with pytest.raises(ValueError, match="observation must be cosine and sine of the angle and the angular velocity"):
        best.predict([0.0, 0.0])
    with pytest.raises(ValueError, match="got Pendulum-v1's over the 2 components of its state"):
        qtab.plots.values(best)


@pytest.mark.slow
def test_with_more_torques_the_table_of_the_pendulum_costs_less() -> None:
    pendulum = found("Pendulum-v1")
    settings: dict[str, Any] = {"seed": 0, "episodes": 1, "discretizer": "bins", "bins": (8, 8, 12)}
    two, many = (pendulum.gap(qtab.train("Pendulum-v1", actions=actions, **settings)) for actions in (2, 7))
    assert two.attainable is not None
    assert many.attainable is not None
    assert many.approximation is not None
    assert many.learning is not None
    assert -165 < two.attainable < many.attainable - 5 < pendulum.expected_return
    assert many.approximation + many.learning == pytest.approx(many.greedy)


def test_an_acrobot_with_noise_has_no_route() -> None:
    env: Any = gym.make("Acrobot-v1")
    env.unwrapped.torque_noise_max = 0.5
    with pytest.raises(ValueError, match=r"torque_noise_max must be 0.0 for method 'search', got 0.5"):
        qtab.optimum(env)
    env.unwrapped.torque_noise_max = 0.0
    env.unwrapped.AVAIL_TORQUE = [-2.0, 0.0, 2.0]
    with pytest.raises(ValueError, match="AVAIL_TORQUE must be"):
        qtab.optimum(env)


@pytest.mark.slow
def test_constants_and_the_time_limit_are_used() -> None:
    env: Any = gym.make("CartPole-v1", max_episode_steps=30)
    assert qtab.optimum(env).expected_return == 30
    book: Any = gym.make("CartPole-v1", sutton_barto_reward=True, max_episode_steps=30)
    book.unwrapped.force_mag = 0.0
    assert -1 < qtab.optimum(book).expected_return < 0  # the reward of the book, -1 where a pole falls, as some do
    env.unwrapped.gravity = float("inf")
    with pytest.raises(ValueError, match="gravity must be finite, got inf"):
        qtab.optimum(env)
