"""``qtab/DynaMaze-v0``: the Dyna maze in eight resolutions (Sutton & Barto, 2nd ed., Examples 8.1 and 8.4)."""

from qtab._utils import checks
from qtab.envs.grid_worlds import DYNA_MAZE, FREE, START, grid_world
from qtab.envs.tabular import TabularEnv

MOST_DOUBLINGS = 7


def scaled_maze(doublings: int) -> tuple[str, ...]:
    """Returns the map of the Dyna maze after doublings: first of the columns, then of rows and columns in turn.

    All cells of the goal are goals; one cell is the start.
    """
    down, across = 2 ** (doublings // 2), 2 ** ((doublings + 1) // 2)
    rows = ["".join(cell * across for cell in row) for row in DYNA_MAZE for _ in range(down)]
    start = next(index for index, row in enumerate(rows) if START in row)
    column = rows[start].index(START)
    cleared = [row.replace(START, FREE) for row in rows]
    cleared[start] = cleared[start][:column] + START + cleared[start][column + 1 :]
    return tuple(cleared)


class DynaMazeEnv(TabularEnv):
    """The Dyna maze: 6 rows, 9 columns, four actions, a reward of 1 at the goal and 0 elsewhere.

    Args:
        doublings: The number of doublings of the cells, 0 to 7: from 47 cells without obstacles to 6,016.

    Raises:
        TypeError: if ``doublings`` is not an integer.
        ValueError: if it is not in 0 to 7.
    """

    def __init__(self, doublings: int = 0) -> None:
        doublings = checks.integer("doublings", doublings, least=0, most=MOST_DOUBLINGS)
        self.layout = scaled_maze(doublings)
        made = grid_world(self.layout, step_reward=0.0, goal_reward=1.0)
        super().__init__(made.P, made.initial_state_distrib)
