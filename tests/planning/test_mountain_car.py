"""The best known policy of MountainCar-v0, driven in Gymnasium, and how optima are shown to users."""

import json
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.processes.command import qtab_here, refused
from support.processes.interrupts import in_a_process
from support.processes.posix import posix_only

EPISODES = 40


@pytest.fixture(scope="module")
def found() -> qtab.Optimum:
    return qtab.optimum("MountainCar-v0")


def drive(env: gym.Env, position: float, actions: Any) -> list[bool]:
    """Whether each step ended the episode, in Gymnasium's own environment."""
    env.reset()
    inner: Any = env.unwrapped
    inner.state = (position, 0.0)
    return [bool(inner.step(int(action))[2]) for action in actions]


def test_every_route_reaches_the_goal_in_gymnasium_with_its_last_action(found):
    env = gym.make("MountainCar-v0", disable_env_checker=True)
    search = found.search
    for position, steps, route in zip(search.starts, search.steps, search.routes, strict=True):
        ended = drive(env, float(position), route)
        assert ended == [False] * (steps - 1) + [True]
    assert found.expected_return == -search.steps.mean()


def test_the_optimum_is_labelled_best_known_and_not_exact(found):
    assert (found.method, found.exact, found.label) == ("search", False, "best known")
    assert -98 < found.expected_return < -97.6
    assert found.expected_return >= found.search.predict_return > -98
    assert "not proven optimal" in str(found)
    assert found.reward_threshold == -110


def test_the_same_search_is_not_made_again_and_its_results_cannot_be_changed(found, monkeypatch):
    def refuse(*arguments: Any) -> Any:
        raise AssertionError(f"searched again: {arguments}")

    monkeypatch.setattr("qtab._core.GridSearch", refuse)
    again: Any = qtab.optimum("MountainCar-v0")
    for name in ("values", "q_values", "policy"):
        assert getattr(again, name).tobytes() == getattr(found, name).tobytes()
    assert again.expected_return == found.expected_return
    again.values[:] = 0  # its own
    assert found.values.any()
    for array in (again.search.starts, again.search.steps, again.search.routes[0], again.search.positions):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    with pytest.raises(AssertionError, match="searched again"):
        qtab.optimum("MountainCar-v0", env_kwargs={"goal_velocity": -0.0})


def test_start_positions_cover_gymnasiums_range(found):
    starts = found.search.starts
    assert len(starts) == 1000
    assert -0.6 < starts[0] < starts[-1] < -0.4
    np.testing.assert_allclose(np.diff(starts), 0.2 / 1000)


def test_predicted_actions_reach_the_estimated_return(found):
    env = gym.make("MountainCar-v0")
    lengths = []
    for episode in range(EPISODES):
        observation, _ = env.reset(seed=0 if episode == 0 else None)
        steps, over = 0, False
        while not over:
            action, state = found.predict(observation)
            assert state is None
            observation, _, terminated, truncated, _ = env.step(action)
            steps, over = steps + 1, terminated or truncated
        lengths.append(steps)
    assert abs(np.mean(lengths) + found.search.predict_return) < 3.5 * np.std(lengths) / np.sqrt(EPISODES)


def test_values_are_negative_costs_to_go_on_the_grid(found):
    search = found.search
    assert found.values.shape == found.policy.shape == (len(search.positions), len(search.velocities))
    assert found.q_values.shape == (*found.values.shape, 3)
    assert (search.positions[0], search.positions[-1]) == (-1.2, 0.6)
    np.testing.assert_allclose(search.velocities[[0, -1]], [-0.07, 0.07])
    position, velocity = np.argmin(np.abs(search.positions + 0.5)), np.argmin(np.abs(search.velocities))
    assert found.values[position, velocity] == pytest.approx(-search.steps[500], abs=3)
    right = np.argmin(np.abs(search.positions - 0.45))
    assert found.values[right, -1] == pytest.approx(-1.0, abs=0.5)
    assert (found.policy == found.q_values.argmax(axis=-1)).all()
    state = [search.positions[position], search.velocities[velocity]]
    assert found.predict(state)[0] == found.policy[position, velocity]


def test_many_positions_and_velocities_are_answered_at_once(found):
    observations = np.array([[-0.5, 0.0], [-1.0, 0.02], [0.3, -0.01]])
    actions, state = found.predict(observations)
    assert state is None
    assert actions.tolist() == [found.predict(row)[0] for row in observations]
    assert type(found.predict(observations[0])[0]) is int


def test_notebooks_show_its_values_in_a_short_picture(found):
    assert repr(found).startswith("<Optimum of MountainCar-v0: best known expected return -")
    assert "\n" not in repr(found)
    shown = found._repr_html_()
    assert "<svg" in shown
    assert "not proven optimal" in shown
    assert len(shown) < 20_000


@pytest.mark.slow
def test_the_goal_velocity_and_the_time_limit_are_used():
    slower: Any = qtab.optimum("MountainCar-v0", env_kwargs={"goal_velocity": 0.04}, max_episode_steps=100)
    assert slower.search.steps.max() == 100
    env = gym.make("MountainCar-v0", goal_velocity=0.04)
    arrived = 0
    for start, steps, route in zip(slower.search.starts, slower.search.steps, slower.search.routes, strict=True):
        if route is None:
            assert steps == 100
        else:
            arrived += 1
            assert drive(env, float(start), route) == [False] * (steps - 1) + [True]
    assert 0 < arrived < 1000
    never: Any = qtab.optimum("MountainCar-v0", env_kwargs={"goal_velocity": 0.08})
    assert never.expected_return == never.search.predict_return == -200
    assert set(never.search.routes) == {None}


def test_an_edited_environment_is_searched_as_edited():
    env: Any = gym.make("qtab/MountainCar-v0")
    env.unwrapped.force = 0.002
    strong: Any = qtab.optimum(env)
    assert strong.expected_return > -80
    env.reset(seed=0)
    for index in (0, 500, 999):
        assert drive(env, float(strong.search.starts[index]), strong.search.routes[index])[-1]
    env.unwrapped.force = float("nan")
    with pytest.raises(ValueError, match="force must be finite, got nan"):
        qtab.optimum(env)


@pytest.mark.parametrize("edit", [{"max_speed": 0.0}, {"min_position": 0.6}, {"gravity": 1e300}, {"max_speed": -1.0}])
def test_a_car_that_cannot_move_has_no_route(edit):
    env: Any = gym.make("qtab/MountainCar-v0", max_episode_steps=50)
    for name, value in edit.items():
        setattr(env.unwrapped, name, value)
    found: Any = qtab.optimum(env)
    for start, route in zip(found.search.starts, found.search.routes, strict=True):
        if route is not None:
            assert drive(env, float(start), route)[-1]


def test_the_gap_of_a_run_is_its_distance_from_the_optimum(found):
    run = qtab.train("MountainCar-v0", preset="solved", episodes=500, seed=0)
    gap = found.gap(run)
    played = qtab.evaluate(run, 1000, seed=0)
    assert (gap.greedy_return, gap.standard_error) == (played.mean_return, played.standard_error)
    assert 0 < gap.greedy < gap.final
    assert str(gap).startswith(f"greedy policy {gap.greedy_return:.4g} ± ")
    assert "best known -97." in str(gap)


@pytest.mark.parametrize("observation", [[0.0], [0.0, float("nan")], 3])
def test_an_invalid_observation_is_refused(found, observation):
    with pytest.raises(ValueError, match="observation must be a position and a velocity, got"):
        found.predict(observation)


def test_the_optimum_is_drawn_in_learning_curves(found):
    run = qtab.train("MountainCar-v0", episodes=300, seed=0)
    drawings: list[tuple[Any, str]] = [
        (qtab.plot(run, optimum=found), f"best known {found.expected_return:.4g}"),
        (qtab.plot(run, optimum=-98.0), "optimum -98"),
        (qtab.plots.learning_curves(run.episode_returns, optimum=found), f"best known {found.expected_return:.4g}"),
    ]
    for ax, label in drawings:
        [line] = [line for line in ax.lines if line.get_label() == label]
        assert set(line.get_ydata()) == {-98.0 if label.startswith("optimum") else found.expected_return}
        assert label in [text.get_text() for text in ax.get_legend().get_texts()]
        low, high = ax.get_ylim()
        assert low < -98 < high


ENDLESS = """
def interrupt():
    work_for(0.3)
    ctrl_c()
mint = qtab.TabularEnv({0: {0: [(1.0, 0, 1.0, False)]}}, [1.0])
threading.Thread(target=interrupt, daemon=True).start()
try:
    qtab.optimum(mint, max_episode_steps=10**15)
except KeyboardInterrupt:
    print(json.dumps("stopped"))
"""


@posix_only
def test_ctrl_c_stops_planning():
    assert json.loads(in_a_process(ENDLESS).stdout) == "stopped"


def test_the_command_prints_a_small_table(tmp_path: Path):
    done = qtab_here("optimum", "FrozenLake-v1", "--env-kwargs", "is_slippery", "false", cwd=tmp_path)
    assert done.returncode == 0, done
    lines = done.stdout.splitlines()
    assert lines[0] == "FrozenLake-v1"
    assert [line.split("  ")[-1].strip() for line in lines[1:5]] == [
        "1 within 100 steps",
        "none",  # Gymnasium's is for slippery ice
        "finite_horizon, discount 1: exact",
        "16, 4 actions",
    ]
    assert "MountainCarContinuous-v0 is not known" in refused("optimum", "MountainCarContinuous-v0", cwd=tmp_path)
    assert "discount must lie in [0, 1], got 2.0" in refused("optimum", "Taxi-v4", "--discount", "2", cwd=tmp_path)


@pytest.mark.slow
def test_training_reports_the_gap_to_the_optimum(tmp_path: Path):
    done = qtab_here("train", "CliffWalking-v1", "--seed", "0", "--plot", "curve.png", cwd=tmp_path)
    assert "Greedy policy -13, optimum -13, gap 0" in done.stdout.splitlines()
    assert (tmp_path / "curve.png").exists()
    done = qtab_here("train", "FrozenLake-v1", "--seed", "0", "--env-kwargs", "is_slippery", "false", cwd=tmp_path)
    assert "Greedy policy 1, optimum 1, gap 0" in done.stdout.splitlines()
    done = qtab_here("train", "CartPole-v1", "--seed", "0", "--episodes", "50", "--optimum", cwd=tmp_path)
    assert ", best known 500, gap " in done.stdout
    done = qtab_here("train", "CartPole-v1", "--seed", "0", "--episodes", "50", cwd=tmp_path)
    assert "best known" not in done.stdout
