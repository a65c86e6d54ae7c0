"""The book's grid worlds as transition tables. Cells are numbered row by row from the upper left corner."""

from collections.abc import Callable

from qtab.envs.tabular import Outcome, TabularEnv

Cell = tuple[int, int]
"""A row and a column, from the upper left corner."""

UP, RIGHT, DOWN, LEFT = range(4)
"""Actions, as in Gymnasium's CliffWalking."""
_MOVES = {UP: (-1, 0), RIGHT: (0, 1), DOWN: (1, 0), LEFT: (0, -1)}

_WIND = (0, 0, 0, 1, 1, 1, 2, 2, 1, 0)
"""How many cells up each column of the windy grid world blows."""

_MAZE = (
    ".......#G",
    "..#....#.",
    "S.#....#.",
    "..#......",
    ".....#...",
    ".........",
)
"""The Dyna maze: obstacles, start and goal."""


def windy_grid_world() -> TabularEnv:
    """Returns the windy grid world (Example 6.5): 7 rows of 10 columns, four actions, -1 a step to the goal.

    The wind of the column that is left shifts every move upwards. The shortest way takes 15 steps.
    """

    def step(cell: Cell, action: int) -> Cell:
        row, column = cell
        down, right = _MOVES[action]
        return _clip(row + down - _WIND[column], 7), _clip(column + right, 10)

    rows, columns, start, goal = 7, 10, (3, 0), (3, 7)
    return _grid_world(rows, columns, start, goal, step, step_reward=-1.0, goal_reward=-1.0)


def dyna_maze() -> TabularEnv:
    """Returns the Dyna maze (Example 8.1): 6 rows of 9 columns, four actions, nothing but 1 for reaching the goal.

    A move into an obstacle or over the edge stays where it is. The shortest way takes 14 steps.
    """
    rows, columns = len(_MAZE), len(_MAZE[0])
    found = {_MAZE[row][column]: (row, column) for row in range(rows) for column in range(columns)}

    def step(cell: Cell, action: int) -> Cell:
        down, right = _MOVES[action]
        row, column = _clip(cell[0] + down, rows), _clip(cell[1] + right, columns)
        return cell if _MAZE[row][column] == "#" else (row, column)

    return _grid_world(rows, columns, found["S"], found["G"], step, step_reward=0.0, goal_reward=1.0)


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
    def number(cell: Cell) -> int:
        return cell[0] * columns + cell[1]

    def outcome(cell: Cell, action: int) -> Outcome:
        there = step(cell, action)
        return 1.0, number(there), goal_reward if there == goal else step_reward, there == goal

    cells = [(row, column) for row in range(rows) for column in range(columns)]
    table = {number(cell): {action: [outcome(cell, action)] for action in _MOVES} for cell in cells}
    return TabularEnv(table, [float(cell == start) for cell in cells])


def _clip(number: int, count: int) -> int:
    return min(max(number, 0), count - 1)
