"""Grid worlds as transition tables: those of Sutton & Barto's book, and any given as a map of text.

A state is the number of a cell, counted row by row from the upper left corner.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from qtab._utils import checks
from qtab._utils.shown import shown
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

WIND = (0, 0, 0, 1, 1, 1, 2, 2, 1, 0)
"""The number of cells by which the wind of each column shifts a move upwards."""

WALL, START, GOAL, FREE = "#SG."

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
    return grid_world(WINDY_GRID_WORLD, wind=WIND, step_reward=-1.0, goal_reward=-1.0)


def dyna_maze() -> TabularEnv:
    """Returns the Dyna maze (Example 8.1): 6 rows, 9 columns, four actions, a reward of 1 at the goal and 0 elsewhere.

    A move into an obstacle or off the grid leaves the agent in its cell. The shortest path takes 14 steps.
    """
    return grid_world(DYNA_MAZE, step_reward=0.0, goal_reward=1.0)


def grid_world(
    layout: Sequence[str],
    *,
    wind: Sequence[int] | None = None,
    step_reward: float = -1.0,
    goal_reward: float = 0.0,
    rewards: Mapping[Cell, float] | None = None,
) -> TabularEnv:
    """Returns the grid world of a map, with four actions: up, right, down, left.

    A move that would end in a wall leaves the agent in its cell, and the edge of the grid stops it.

    Args:
        layout: The rows of the map, of one length: ``"."`` a free cell, ``"#"`` a wall, ``"S"`` a start, ``"G"`` a
            goal, which ends the episode. An episode begins in any of the starts with the same probability. Without a
            goal only a time limit ends it.
        wind: For each column the number of cells by which a move that begins there is shifted upwards.
        step_reward: The reward of a step.
        goal_reward: The reward of a step into a goal.
        rewards: Other rewards for steps into certain cells, by (row, column).

    Raises:
        ValueError: if the map, the wind or a cell does not fit, or a reward is not finite.
    """
    rows, columns = _size(layout)
    wind = [0] * columns if wind is None else list(wind)
    if len(wind) != columns:
        raise ValueError(f"wind must hold {columns} integers, one for each column, got {shown(wind)}")
    shifts = [checks.integer("wind", shift, least=0) for shift in wind]
    step_reward = checks.finite("step_reward", step_reward)
    goal_reward = checks.finite("goal_reward", goal_reward)
    cells = [(row, column) for row in range(rows) for column in range(columns)]
    starts = [cell for cell in cells if layout[cell[0]][cell[1]] == START]
    if not starts:
        raise ValueError(f"layout must have a start, {START!r}, got {shown(layout)}")
    entered = {cell: goal_reward if layout[cell[0]][cell[1]] == GOAL else step_reward for cell in cells}
    for cell, reward in (rewards or {}).items():
        if cell not in entered:
            raise ValueError(f"rewards must name cells (row, column) of the {rows} x {columns} grid, got {shown(cell)}")
        entered[cell] = checks.finite("rewards", reward)

    def transition(cell: Cell, action: int) -> Transition:
        (row, column), (down, right) = cell, _MOVES[action]
        next_cell = _clip(row + down - shifts[column], rows), _clip(column + right, columns)
        if layout[next_cell[0]][next_cell[1]] == WALL:
            next_cell = cell
        at_goal = layout[next_cell[0]][next_cell[1]] == GOAL
        return 1.0, next_cell[0] * columns + next_cell[1], float(entered[next_cell]), at_goal

    table = {state: {action: [transition(cell, action)] for action in _MOVES} for state, cell in enumerate(cells)}
    return with_names(TabularEnv(table, [float(cell in starts) / len(starts) for cell in cells]), layout)


def with_names(env: TabularEnv, layout: Sequence[str]) -> TabularEnv:
    """Gives an environment its map and the names of its actions, for texts that name them; returns it."""
    named: Any = env  # not every transition table has a map
    named.layout, named.action_names = tuple(layout), ACTION_NAMES
    return env


def _size(layout: Sequence[str]) -> tuple[int, int]:
    """Checks a map, and returns its numbers of rows and columns."""
    rows = len(layout)
    lengths = {len(row) for row in layout}
    if isinstance(layout, str) or len(lengths) != 1 or 0 in lengths:
        raise ValueError(f"layout must hold rows of one length, got {shown(layout)}")
    if unknown := set("".join(layout)) - {WALL, START, GOAL, FREE}:
        raise ValueError(
            f"layout must consist of {FREE!r}, {WALL!r}, {START!r} and {GOAL!r}, got {shown(min(unknown))}"
        )
    return rows, lengths.pop()


def _clip(index: int, count: int) -> int:
    return min(max(index, 0), count - 1)


_JUMPS = {(0, 1): ((4, 1), 10.0), (0, 3): ((2, 3), 5.0)}
"""From the special states A and B: the next cell, and the reward."""

GRID_WORLD_5X5 = (".A.B.", ".....", "...b.", ".....", ".a...")
"""The map of Example 3.5, for ``layout=`` of pictures: A leads to a, and B to b."""
GRID_WORLD_4X4 = ("G...", "....", "....", "...G")
"""The map of Example 4.1: two goals."""


def grid_world_5x5() -> TabularEnv:
    """Returns the grid world of Examples 3.5 and 3.8: 5 rows, 5 columns, four actions, no terminal state.

    Every action in A, in the first row, leads to A' in the last row with a reward of 10, and every action in B to B'
    with a reward of 5. A move off the grid leaves the agent in its cell with a reward of -1; all other rewards are 0.
    An episode starts in any cell, each with the same probability.
    """
    size = 5

    def transition(row: int, column: int, action: int) -> Transition:
        if (row, column) in _JUMPS:
            (next_row, next_column), reward = _JUMPS[row, column]
            return 1.0, next_row * size + next_column, reward, False
        next_row, next_column = row + _MOVES[action][0], column + _MOVES[action][1]
        if 0 <= next_row < size and 0 <= next_column < size:
            return 1.0, next_row * size + next_column, 0.0, False
        return 1.0, row * size + column, -1.0, False

    cells = [(row, column) for row in range(size) for column in range(size)]
    table = [[[transition(*cell, action)] for action in _MOVES] for cell in cells]
    return with_names(TabularEnv(table, [1 / len(cells)] * len(cells)), GRID_WORLD_5X5)


def grid_world_4x4() -> TabularEnv:
    """Returns the grid world of Example 4.1: 4 rows, 4 columns, four actions, a reward of -1 per step.

    The upper left and the lower right cell are terminal. A move off the grid leaves the agent in its cell. An episode
    starts in any other cell, each with the same probability.
    """
    size = 4
    goals = (0, size * size - 1)

    def transition(state: int, action: int) -> Transition:
        if state in goals:
            return 1.0, state, 0.0, True
        row, column = divmod(state, size)
        next_row = min(max(row + _MOVES[action][0], 0), size - 1)
        next_column = min(max(column + _MOVES[action][1], 0), size - 1)
        next_state = next_row * size + next_column
        return 1.0, next_state, -1.0, next_state in goals

    states = range(size * size)
    table = [[[transition(state, action)] for action in _MOVES] for state in states]
    starts = [float(state not in goals) / (len(states) - len(goals)) for state in states]
    return with_names(TabularEnv(table, starts), GRID_WORLD_4X4)
