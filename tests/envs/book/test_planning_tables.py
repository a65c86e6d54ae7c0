"""The tables of chapters 3, 4 and 8: their numbers by hand, by the book and by simulation."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.envs.book.gamblers_problem import gamblers_problem
from qtab.envs.book.jacks_car_rental import MAX_MOVED, cars_moved, jacks_car_rental
from qtab.envs.book.random_mdp import random_mdp
from qtab.envs.grid_worlds import DOWN, LEFT, RIGHT, UP, grid_world_4x4, grid_world_5x5

IDS = ("GridWorld5x5-v0", "GridWorld4x4-v0", "GamblersProblem-v0", "JacksCarRental-v0", "RandomMdp-v0")


def test_the_values_of_example_3_5_and_3_8_are_the_books():
    env = grid_world_5x5()
    book = [[3.3, 8.8, 4.4, 5.3, 1.5], [1.5, 3.0, 2.3, 1.9, 0.5], [0.1, 0.7, 0.7, 0.4, -0.4]]
    book += [[-1.0, -0.4, -0.4, -0.6, -1.2], [-1.9, -1.3, -1.2, -1.4, -2.0]]
    values = qtab.policy_values(env, "random", 0.9).values.reshape(5, 5)
    assert np.abs(values - book).max() < 0.0501
    best = [[22.0, 24.4, 22.0, 19.4, 17.5], [19.8, 22.0, 19.8, 17.8, 16.0], [17.8, 19.8, 17.8, 16.0, 14.4]]
    best += [[16.0, 17.8, 16.0, 14.4, 13.0], [14.4, 16.0, 14.4, 13.0, 11.7]]
    optimum = qtab.optimum(env, discount=0.9, method="value_iteration")
    assert np.abs(optimum.values.reshape(5, 5) - best).max() < 0.0501


def test_the_small_grid_world_has_the_books_values():
    values = qtab.policy_values(grid_world_4x4(), "random").values.reshape(4, 4)
    book = [[0, -14, -20, -22], [-14, -18, -20, -20], [-20, -20, -18, -14], [-22, -20, -14, 0]]
    np.testing.assert_allclose(values, book, atol=1e-10)
    env = grid_world_4x4()
    assert env.P[1][LEFT] == [(1.0, 0, -1.0, True)]
    assert env.P[1][UP] == [(1.0, 1, -1.0, False)]
    assert env.P[14][RIGHT] == [(1.0, 15, -1.0, True)]
    assert env.P[4][DOWN] == [(1.0, 8, -1.0, False)]


def test_the_gambler_wins_with_the_known_probability():
    # Betting everything from half of the goal wins with the probability of heads, and nothing does better for p < 0.5.
    best = qtab.optimum(gamblers_problem(0.4), method="value_iteration")
    assert best.values[[25, 50, 75]] == pytest.approx([0.16, 0.4, 0.64], abs=1e-12)
    fair = qtab.optimum(gamblers_problem(0.5, goal=10), method="value_iteration")
    np.testing.assert_allclose(fair.values[1:10], np.arange(1, 10) / 10, atol=1e-9)


@pytest.mark.slow
def test_the_rental_has_the_income_and_the_cars_of_a_simulation():
    env, rng, days = jacks_car_rental(), np.random.default_rng(0), 200_000
    for first, second, action in ((20, 20, 3), (3, 15, 9), (0, 2, 0)):
        state = first * 21 + second
        moved = cars_moved(first, second, action)
        assert -second <= moved <= first
        rented = [
            np.minimum(rng.poisson(3, days), first - moved),
            np.minimum(rng.poisson(4, days), second + moved),
        ]
        income = 10 * (rented[0] + rented[1]) - 2 * abs(moved)
        probabilities, states, rewards, ends = zip(*env.P[state][action], strict=True)
        assert not any(ends)
        assert len(set(rewards)) == 1
        assert rewards[0] == pytest.approx(income.mean(), abs=4 * income.std() / days**0.5 + 1e-9)
        left = np.minimum(first - moved - rented[0] + rng.poisson(3, days), 20)
        expected = float(np.dot(probabilities, np.array(states) // 21))
        assert expected == pytest.approx(left.mean(), abs=4 * left.std() / days**0.5 + 1e-9)
    assert sum(cars_moved(10, 10, action) for action in range(2 * MAX_MOVED + 1)) == 0


def test_a_random_task_has_the_asked_for_form():
    env = random_mdp(50, 3, seed=7, actions=4)
    assert (len(env.P), len(env.P[0]), len(env.P[0][0])) == (50, 4, 4)
    assert env.P[5][2][-1] == (0.1, 0, 0.0, True)
    assert env.P[5][2][0][0] == pytest.approx(0.3)
    rewards = [reward for row in env.P.values() for pair in row.values() for _, _, reward, _ in pair[:-1]]
    assert abs(np.mean(rewards)) < 0.2 > abs(np.std(rewards) - 1)
    assert random_mdp(50, 3, seed=7, actions=4).P == env.P != random_mdp(50, 3, seed=8, actions=4).P


@pytest.mark.parametrize("name", IDS)
def test_each_trains_in_rust_by_its_id(name):
    settings: Any = {"episodes": 2, "max_episode_steps": 20, "seed": 1}
    kwargs: Any = {"cars": 4} if name.startswith("Jacks") else {"states": 20} if name.startswith("Random") else {}
    run = qtab.train(f"qtab/{name}", env_kwargs=kwargs, **settings)
    assert run.config.backend == "rust"
    assert qtab.verify(run).equal
    env = gym.make(f"qtab/{name}", **kwargs)
    assert isinstance(env.unwrapped, qtab.TabularEnv)


@pytest.mark.parametrize(
    ("make", "arguments", "error"),
    [
        (gamblers_problem, {"probability": 1.5}, ValueError),
        (gamblers_problem, {"goal": 1}, ValueError),
        (jacks_car_rental, {"cars": 0}, ValueError),
        (jacks_car_rental, {"cars": 2.5}, TypeError),
        (random_mdp, {"states": 0}, ValueError),
        (random_mdp, {"branching": 0}, ValueError),
        (random_mdp, {"termination": 2.0}, ValueError),
        (random_mdp, {"seed": "first"}, TypeError),
    ],
)
def test_bad_arguments_are_refused_by_name(make, arguments, error):
    with pytest.raises(error, match=f"{next(iter(arguments))} must"):
        make(**arguments)


def test_a_table_keeps_one_copy_of_a_list_that_stands_for_several_actions():
    transitions = [(1.0, 0, 0.0, False)]
    env = qtab.TabularEnv([[transitions, transitions, list(transitions)]], [1.0])
    assert env.P[0][0] is env.P[0][1] is not env.P[0][2]
    transitions.append((0.0, 0, 0.0, True))
    assert len(env.P[0][0]) == 1
