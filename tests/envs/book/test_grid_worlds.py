"""Grid worlds from maps."""

import pytest

import qtab
from qtab.envs.grid_worlds import ACTION_NAMES, grid_world

UP, RIGHT, DOWN, LEFT = range(4)


def test_walls_and_the_edge_stop_a_move():
    env = grid_world(["S#", ".G"])
    start = env.P[0]
    assert [start[action] for action in (UP, RIGHT, LEFT)] == [[(1.0, 0, -1.0, False)]] * 3
    assert start[DOWN] == [(1.0, 2, -1.0, False)]
    assert env.P[2][RIGHT] == [(1.0, 3, 0.0, True)]
    assert list(env.initial_state_distrib) == [1, 0, 0, 0]
    assert len(ACTION_NAMES) == len(start)


def test_wind_shifts_moves_upwards():
    env = grid_world(["...", "...", "S.G"], wind=[0, 2, 0])
    assert env.P[7][RIGHT] == [(1.0, 2, -1.0, False)]
    assert env.P[6][RIGHT] == [(1.0, 7, -1.0, False)]


def test_rewards_are_those_of_the_cell_that_is_entered():
    env = grid_world(["S.G"], step_reward=-0.5, goal_reward=3, rewards={(0, 1): -7})
    assert env.P[0][RIGHT] == [(1.0, 1, -7.0, False)]
    assert env.P[1][LEFT] == [(1.0, 0, -0.5, False)]
    assert env.P[1][RIGHT] == [(1.0, 2, 3.0, True)]
    assert env.P[1][UP] == [(1.0, 1, -7.0, False)]


def test_several_starts_are_equally_likely():
    assert list(grid_world(["SSS.G"]).initial_state_distrib) == [1 / 3, 1 / 3, 1 / 3, 0, 0]


def test_the_windy_grid_world_is_the_books():
    env = qtab.book.windy_grid_world()
    assert env.P[36][RIGHT] == [(1.0, 17, -1.0, False)]
    assert env.P[48][LEFT] == [(1.0, 37, -1.0, True)]


@pytest.mark.parametrize(
    ("layout", "arguments", "message"),
    [
        ([], {}, "layout must hold rows of one length"),
        (["S.", "."], {}, "layout must hold rows of one length"),
        ("S.G", {}, "layout must hold rows of one length"),
        (["..G"], {}, "layout must have a start, 'S'"),
        (["SxG"], {}, "layout must consist of '.', '#', 'S' and 'G', got 'x'"),
        (["S.G"], {"wind": [0, 1]}, "wind must hold 3 integers, one for each column"),
        (["S.G"], {"wind": [0, -1, 0]}, "wind must be an integer of at least 0, got -1"),
        (["S.G"], {"rewards": {(1, 0): 2}}, "rewards must name cells (row, column) of the 1 x 3 grid, got (1, 0)"),
        (["S.G"], {"rewards": {(0, 0): float("nan")}}, "rewards must be finite, got nan"),
        (["S.G"], {"step_reward": float("inf")}, "step_reward must be finite, got inf"),
    ],
)
def test_maps_that_do_not_fit_are_refused(layout, arguments, message):
    with pytest.raises(ValueError, match="^" + message.replace("(", r"\(").replace(")", r"\)")):
        grid_world(layout, **arguments)
