"""Explanations and findings name states and actions as pictures do."""

import re
from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.envs.grid_worlds import ACTION_NAMES
from qtab.explanation.text import text
from qtab.results.words import Names, cell_in_words

FLOOR = ("S..", "..#", "..G")
ACTIONS = ("north", "east", "south", "west")


class Floor(gym.Env[Any, Any]):
    """A room of 3 x 3 cells, without names."""

    observation_space = gym.spaces.Discrete(9)
    action_space = gym.spaces.Discrete(4)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed)
        self.state = 0
        return 0, {}

    def step(self, action: int) -> Any:
        self.state = min(self.state + 1, 8)
        return self.state, -1.0, self.state == 8, False, {}


class NamedFloor(Floor):
    layout = FLOOR
    action_names = ACTIONS


def explained(env: Any, **options: Any) -> Any:
    run = qtab.train(env, episodes=3, seed=0, max_episode_steps=20)
    return qtab.explain(run, episode=1, steps=1, env=env, **options)[0]


def test_a_call_names_states_and_actions() -> None:
    step = explained(Floor(), layout=FLOOR, action_names=ACTIONS)
    assert (step.state, step.next_state) == ("row 0, column 0", "row 0, column 1")
    assert step.action_name in ACTIONS
    assert explained(Floor(), layout=(3, 3)).state == "row 0, column 0"
    assert explained(NamedFloor(), action_names=("a", "b", "c", "d")).action_name in {"a", "b", "c", "d"}


class FloorFromOne(Floor):
    """The same room, whose states are numbered from 1."""

    observation_space = gym.spaces.Discrete(9, start=1)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        observation, info = super().reset(seed=seed, options=options)
        return observation + 1, info

    def step(self, action: int) -> Any:
        observation, *others = super().step(action)
        return observation + 1, *others


def test_the_cells_of_a_map_start_with_the_first_state() -> None:
    step = explained(FloorFromOne(), layout=FLOOR)
    assert (int(step.observation), step.state, step.next_state) == (1, "row 0, column 0", "row 0, column 1")
    run = qtab.train(FloorFromOne(), episodes=3, seed=0, max_episode_steps=20)
    assert cell_in_words(run, 0, columns=3) == "row 0, column 0"
    assert cell_in_words(run, 8, columns=3) == "row 2, column 2"
    assert cell_in_words(run, 0) == explained(FloorFromOne()).state == "1"


def test_an_environment_names_states_and_actions() -> None:
    step = explained(NamedFloor())
    assert (step.state, step.next_state) == ("row 0, column 0", "row 0, column 1")
    assert step.action_name in ACTIONS


def test_the_value_of_each_action_is_named() -> None:
    named, unnamed = (text("", [explained(floor())]) for floor in (NamedFloor, Floor))
    (line,) = re.findall(r"values (.*)", named)
    assert [part.rpartition(" ")[0] for part in line.split(", ")] == [*ACTIONS]
    assert re.search(r"values [^a-z]*\n", unnamed)


def test_without_names_there_are_numbers() -> None:
    step = explained(Floor())
    assert step.state == "0"
    assert step.action_name in {"action 0", "action 1", "action 2", "action 3"}


def test_grid_worlds_have_names() -> None:
    step = explained(qtab.book.windy_grid_world())
    assert step.state == "row 3, column 0"
    assert step.action_name in ACTION_NAMES


@pytest.mark.parametrize(
    ("env", "state"), [("qtab/DynaMaze-v0", "row 2, column 0"), ("qtab/BlockingMaze-v0", "row 5, column 3")]
)
def test_the_mazes_of_the_book_have_names(env: str, state: str) -> None:
    run = qtab.train(env, episodes=2, seed=0, max_episode_steps=50)
    assert qtab.explain(run, steps=1)[0].state == state


def test_planning_updates_and_traces_have_names() -> None:
    run = qtab.train("FrozenLake-v1", algorithm="dyna_q", episodes=2, seed=0)
    planned = qtab.explain(run, steps=1)[0].planning[0]
    assert (planned.state, planned.action_name) == ("row 0, column 0", "left")
    run = qtab.train("CliffWalking-v1", algorithm="sarsa_lambda", episodes=2, seed=0, max_episode_steps=50)
    explanation = qtab.explain(run, steps=3)
    assert explanation[0].traces[0].state == "row 3, column 0"
    assert f"row 3, column 0, {explanation[0].action_name}: z = 1" in str(explanation)


def test_cells_of_a_box_have_the_bounds_of_their_axes() -> None:
    run = qtab.train("MountainCar-v0", episodes=1, seed=0)
    first, second = run.axes
    row = 2 * run.q_table.shape[1] + 3
    expected = f"position from {first.edges[2]:.4g} to {first.edges[3]:.4g}, "
    assert cell_in_words(run, row) == expected + f"velocity from {second.edges[3]:.4g} to {second.edges[4]:.4g}"
    blackjack = qtab.train("Blackjack-v1", episodes=1, seed=0)
    assert cell_in_words(blackjack, 13 * 22 + 2 * 5 + 1) == "player's sum 13, dealer's card 5, usable ace yes"
    assert Names.of(run, gym.make("MountainCar-v0")).actions == run.action_names


def test_the_diagnosis_names_states() -> None:
    run = qtab.train("CliffWalking-v1", episodes=2, seed=0, max_episode_steps=20)
    (found,) = [finding for finding in qtab.diagnose(run).findings if finding.name == "coverage"]
    assert "such as in row 0, column 0; row 0, column 1; row 0, column 2." in found.meaning


def test_names_that_do_not_fit_are_refused() -> None:
    run = qtab.train("CliffWalking-v1", episodes=2, seed=0, max_episode_steps=20)
    with pytest.raises(ValueError, match="layout must have 48 cells"):
        qtab.explain(run, layout=FLOOR)
    with pytest.raises(ValueError, match="action_names must hold 4 names, got 2"):
        qtab.explain(run, action_names=("a", "b"))
    with pytest.raises(TypeError, match="action_names must hold a name for each action, got 'abcd'"):
        qtab.explain(run, action_names="abcd")
    car = qtab.train("MountainCar-v0", episodes=1, seed=0)
    with pytest.raises(ValueError, match="layout must be None for MountainCar-v0, whose observations"):
        qtab.explain(car, layout=FLOOR)
