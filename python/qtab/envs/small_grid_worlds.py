"""The small grid worlds of chapters 3 and 4 of Sutton & Barto's book as transition tables.

A state is the number of a cell, counted row by row from the upper left corner. The actions are those of
:mod:`qtab.envs.grid_worlds`.
"""

from qtab.envs.grid_worlds import DOWN, LEFT, RIGHT, UP
from qtab.envs.tabular import TabularEnv, Transition

_MOVES = {UP: (-1, 0), RIGHT: (0, 1), DOWN: (1, 0), LEFT: (0, -1)}
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
    return TabularEnv(table, [1 / len(cells)] * len(cells))


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
    return TabularEnv(table, [float(state not in goals) / (len(states) - len(goals)) for state in states])
