"""The gap between a run and the optimum of its environment."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.lockstep.toy_text import IDS

MINT = qtab.TabularEnv({0: {0: [(1.0, 0, 1.0, False)], 1: [(1.0, 0, 0.0, True)]}}, [1.0])
"""A reward of 1 for every step."""


@pytest.mark.parametrize("name", IDS)
def test_the_exact_return_of_a_greedy_policy_matches_its_evaluation(name):
    run = qtab.train(name, seed=3, episodes=3000)
    gap = qtab.optimum(run).gap(run)
    played = qtab.evaluate(run, episodes=2000, seed=1)
    assert abs(played.mean_return - gap.greedy_return) <= 3.5 * played.standard_error + 1e-9
    assert gap.standard_error == 0
    assert gap.final_return == run.episode_returns[-100:].mean()
    assert (gap.final, gap.greedy) == (gap.optimum - gap.final_return, gap.optimum - gap.greedy_return)
    assert gap.greedy >= -1e-12


def test_the_fickle_passenger_is_modelled_exactly():
    kwargs = {"fickle_passenger": True, "fickle_probability": 0.6}
    run = qtab.train("Taxi-v4", env_kwargs=kwargs, seed=0, episodes=6000)
    found = qtab.optimum(run)
    gap, played = found.gap(run), qtab.evaluate(run, episodes=3000, seed=1)
    assert abs(played.mean_return - gap.greedy_return) <= 3.5 * played.standard_error
    steady = qtab.optimum("Taxi-v4")
    assert found.expected_return != steady.expected_return
    # While the passenger is in the taxi, the observation does not show whether the destination has changed.
    env: Any = gym.make("Taxi-v4").unwrapped
    aboard = [env.encode(row, column, 4, wish) for row, column, wish in np.ndindex(5, 5, 4)]
    refused = 0
    for state in aboard:
        try:
            found.predict(state)
        except ValueError as error:
            refused += str(error) == f"the best action depends on what the observation {state} does not show"
    assert 0 < refused < len(aboard)


def test_the_gap_is_computed_for_many_runs():
    runs = qtab.train_many("FrozenLake-v1", seeds=4, episodes=2000, tables=True)
    found = qtab.optimum(runs)
    gap = found.gap(runs)
    assert gap.greedy_return.tolist() == [found.gap(run).greedy_return for run in runs]
    assert gap.final.tolist() == (found.expected_return - runs.final_returns(100)).tolist()
    assert np.isnan(found.gap(qtab.train_many("FrozenLake-v1", seeds=4, episodes=200)).greedy).all()


def test_the_gap_requires_a_run_of_the_same_environment_and_time_limit():
    found = qtab.optimum("FrozenLake-v1")
    with pytest.raises(ValueError, match="run must have env 'FrozenLake-v1' as this optimum has, got 'Taxi-v4'"):
        found.gap(qtab.train("Taxi-v4", episodes=2, seed=0))
    with pytest.raises(ValueError, match="run must have max_episode_steps 100 as this optimum has, got 50"):
        found.gap(qtab.train("FrozenLake-v1", episodes=2, seed=0, max_episode_steps=50))
    with pytest.raises(ValueError, match="run must have env_kwargs"):
        found.gap(qtab.train("FrozenLake-v1", episodes=2, seed=0, env_kwargs={"is_slippery": False}))
    with pytest.raises(TypeError, match="run must be a Run or Runs, got 3"):
        found.gap(3)  # type: ignore[call-overload]
    own = qtab.train(MINT, episodes=2, seed=0, max_episode_steps=5)
    with pytest.raises(
        ValueError, match="env must be an environment object for this run: its environment 'TabularEnv'"
    ):
        qtab.optimum(own)
    assert qtab.optimum(MINT, max_episode_steps=5).gap(own).optimum == 5.0
    with pytest.raises(ValueError, match="env_kwargs must be None with a run"):
        qtab.optimum(own, env_kwargs={})


def test_default_keyword_arguments_equal_those_left_out():
    said = {"is_slippery": True, "map_name": "4x4"}
    run = qtab.train("qtab/FrozenLake-v1", episodes=2, seed=0, env_kwargs=said)
    assert qtab.optimum("FrozenLake-v1", env_kwargs={"is_slippery": True}).gap(run).optimum > 0.7
    dry = qtab.train("FrozenLake-v1", episodes=2, seed=0, env_kwargs={"is_slippery": False})
    assert qtab.optimum(dry).gap(dry).optimum == 1.0


@pytest.mark.parametrize("options", [{"discretizer": lambda state: 15 - state, "shape": 16}, {"max_rows": 15}])
def test_rows_that_are_not_the_states_are_refused(options: dict[str, Any]) -> None:
    """A table of as many rows as there are states is not one of the states: their policy would be another."""
    run = qtab.train("FrozenLake-v1", episodes=5, seed=0, **options)
    best = qtab.optimum("FrozenLake-v1")
    for compare in (best.gap, lambda one: qtab.plots.difference(one, best)):
        with pytest.raises(ValueError, match="run must have a table of the components of its observations, not of"):
            compare(run)


@pytest.fixture(scope="module")
def car() -> qtab.Optimum:
    return qtab.optimum("MountainCar-v0")


def test_a_gap_is_split_into_what_the_table_costs_and_what_was_not_learned(car):
    run = qtab.train("MountainCar-v0", seed=0, episodes=300)
    gap = car.gap(run)
    assert gap.approximation == gap.optimum - gap.attainable
    assert gap.learning == gap.attainable - gap.greedy_return
    assert gap.approximation + gap.learning == pytest.approx(gap.greedy)
    assert -125 < gap.attainable < -110  # the article's grid; its settings end near -180
    assert f"due to the table, whose best known policy returns {gap.attainable:.4g}, and" in str(gap)
    assert "best known with this table" in gap._repr_html_()
    assert car.gap(run).attainable == gap.attainable


def test_a_finer_grid_costs_less(car):
    coarse, fine = (
        car.gap(qtab.train("MountainCar-v0", seed=0, episodes=1, discretizer="bins", bins=bins)).attainable
        for bins in ((8, 8), (40, 40))
    )
    assert coarse < fine - 10
    assert fine > -110


@pytest.mark.slow
def test_the_best_policy_known_returns_at_least_what_a_run_does():
    runs = qtab.train_many("CartPole-v1", 2, tables=True, episodes=1500)
    gap = qtab.optimum("CartPole-v1").gap(runs)
    assert gap.attainable is not None
    assert gap.greedy_return.max() <= gap.attainable <= gap.optimum


def test_of_more_cells_than_can_be_sampled_no_best_policy_is_known(car):
    run = qtab.train("MountainCar-v0", seed=0, episodes=1, discretizer="bins", bins=(250, 250))
    assert car.gap(run).attainable is None


def test_of_tile_coding_and_of_lost_tables_no_best_policy_is_known(car):
    solved = qtab.train("MountainCar-v0", preset="solved", seed=0, episodes=20)
    without = qtab.train_many("MountainCar-v0", 2, episodes=5)
    for gap in (car.gap(solved), car.gap(without)):
        assert (gap.attainable, gap.approximation, gap.learning) == (None, None, None)
        assert "of the table" not in str(gap)


def test_a_picture_of_the_difference_requires_the_same_arguments_as_a_gap():
    found = qtab.optimum("FrozenLake-v1")
    run = qtab.train("FrozenLake-v1", episodes=2, seed=0, env_kwargs={"is_slippery": False})
    for compare in (found.gap, lambda one: qtab.plots.difference(one, found)):
        with pytest.raises(ValueError, match=r"^run must have env_kwargs"):
            compare(run)


def test_a_time_limit_of_zero_is_refused_with_a_run_too():
    run = qtab.train("FrozenLake-v1", episodes=2, seed=0)
    with pytest.raises(ValueError, match="max_episode_steps must be an integer of at least 1, got 0"):
        qtab.optimum(run, max_episode_steps=0)
