"""Grid worlds of Sutton & Barto's book as transition tables.

A state is the number of a cell, counted row by row from the upper left corner.
"""

from collections.abc import Callable

from qtab.envs.tabular import TabularEnv, Transition

Cell = tuple[int, int]
"""A row and a column, from the upper left corner."""

UP, RIGHT, DOWN, LEFT = range(4)
"""Actions, as in Gymnasium's CliffWalking."""
_MOVES = {UP: (-1, 0), RIGHT: (0, 1), DOWN: (1, 0), LEFT: (0, -1)}

ACTION_NAMES = ("up", "right", "down", "left")
"""The names of the actions, which pictures draw as arrows: ``qtab.plots.policy(..., action_names=ACTION_NAMES)``."""

WINDY_GRID_WORLD = (
    "..........",
    "..........",
    "..........",
    "S......G..",
    "..........",
    "..........",
    "..........",
)
"""The map of the windy grid world, for ``layout=`` of pictures."""

_WIND = (0, 0, 0, 1, 1, 1, 2, 2, 1, 0)
"""The number of cells by which the wind of each column shifts a move upwards."""

DYNA_MAZE = (
    ".......#G",
    "..#....#.",
    "S.#....#.",
    "..#......",
    ".....#...",
    ".........",
)
"""The map of the Dyna maze: obstacles, start and goal."""


def windy_grid_world() -> TabularEnv:
    """Returns the windy grid world (Example 6.5): 7 rows, 10 columns, four actions, a reward of -1 per step.

    Every move is shifted upwards by the wind of the column that it starts from. The shortest path takes 15 steps.
    """
    rows, columns, start, goal = 7, 10, (3, 0), (3, 7)

    def step(cell: Cell, action: int) -> Cell:
        row, column = cell
        down, right = _MOVES[action]
        return _clip(row + down - _WIND[column], rows), _clip(column + right, columns)

    return _grid_world(rows, columns, start, goal, step, step_reward=-1.0, goal_reward=-1.0)


def dyna_maze() -> TabularEnv:
    """Returns the Dyna maze (Example 8.1): 6 rows, 9 columns, four actions, a reward of 1 at the goal and 0 elsewhere.

    A move into an obstacle or off the grid leaves the agent in its cell. The shortest path takes 14 steps.
    """
    rows, columns = len(DYNA_MAZE), len(DYNA_MAZE[0])
    markers = {DYNA_MAZE[row][column]: (row, column) for row in range(rows) for column in range(columns)}

    def step(cell: Cell, action: int) -> Cell:
        down, right = _MOVES[action]
        row, column = _clip(cell[0] + down, rows), _clip(cell[1] + right, columns)
        return cell if DYNA_MAZE[row][column] == "#" else (row, column)

    return _grid_world(rows, columns, markers["S"], markers["G"], step, step_reward=0.0, goal_reward=1.0)


def _grid_world(
    rows: int,
    columns: int,
    start: Cell,
    goal: Cell,
    step: Callable[[Cell, int], Cell],
    *,
    step_reward: float,
    goal_reward: float,
) -> TabularEnv:
    """Returns the environment of a deterministic ``step(cell, action) -> next cell``; the goal is terminal."""

    def state(cell: Cell) -> int:
        return cell[0] * columns + cell[1]

    def transition(cell: Cell, action: int) -> Transition:
        next_cell = step(cell, action)
        at_goal = next_cell == goal
        return 1.0, state(next_cell), goal_reward if at_goal else step_reward, at_goal

    cells = [(row, column) for row in range(rows) for column in range(columns)]
    table = {state(cell): {action: [transition(cell, action)] for action in _MOVES} for cell in cells}
    return TabularEnv(table, [float(cell == start) for cell in cells])


def _clip(index: int, count: int) -> int:
    return min(max(index, 0), count - 1)
