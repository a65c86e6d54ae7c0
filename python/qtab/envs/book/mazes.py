"""The Dyna maze in eight resolutions, and mazes that change (Sutton & Barto, 2nd ed., Examples 8.1 to 8.4)."""

from collections.abc import Sequence
from typing import Any

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


GAP_RIGHT = (
    "........G",
    ".........",
    ".........",
    "########.",
    ".........",
    "...S.....",
)
"""The maze with a path along the right side: 10 steps."""
GAP_LEFT = (*GAP_RIGHT[:3], ".########", *GAP_RIGHT[4:])
"""The maze with a path along the left side: 16 steps."""
BOTH_GAPS = (*GAP_RIGHT[:3], ".#######.", *GAP_RIGHT[4:])
"""The maze with both paths."""


class ChangingMazeEnv(TabularEnv):
    """A maze that changes after a number of steps, counted over all episodes: part of the state of the environment.

    ``reset(seed=...)`` starts with the first maze and a count of 0; ``reset()`` continues the count. An agent in a cell
    where an obstacle appears can leave it. Each reset and each step draws one ``np_random.random()``, as
    :class:`qtab.TabularEnv` does. The reward is 1 at the goal and 0 elsewhere.

    :func:`qtab.evaluate` seeds its environment, and therefore begins with the first maze: with
    ``env_kwargs={"change_after": 0}`` it plays in the second one.

    Args:
        before: The map of the maze for the first steps, as :func:`qtab.book.grid_world` takes it.
        after: The map of the maze for all later steps.
        change_after: The number of steps in the first maze.

    Raises:
        TypeError: if ``change_after`` is not an integer.
        ValueError: if it is negative.
    """

    def __init__(self, before: Sequence[str], after: Sequence[str], change_after: int) -> None:
        self.change_after = checks.integer("change_after", change_after, least=0)
        self.mazes = tuple(grid_world(layout, step_reward=0.0, goal_reward=1.0) for layout in (before, after))
        first, _ = self.mazes
        super().__init__(first.P, first.initial_state_distrib)
        self.layout = tuple(before)
        self.total_steps = 0

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        """Starts an episode; with a seed, in the first maze."""
        if seed is not None:
            self.total_steps = 0
        return super().reset(seed=seed, options=options)

    def step(self, action: Any) -> Any:
        """Takes a step in the current maze.

        Raises:
            AssertionError: for an action outside the space.
        """
        self.P = self.mazes[self.total_steps >= self.change_after].P
        self.total_steps += 1
        return super().step(action)

    def resume_after(self, total_steps: int) -> None:
        """Sets the count of steps; :func:`qtab.resume` and replays call it."""
        self.total_steps = total_steps


class BlockingMazeEnv(ChangingMazeEnv):
    """The blocking maze (Example 8.2): the path along the right side is blocked, and one along the left side opens.

    Args:
        change_after: The number of steps after which the maze changes.
    """

    def __init__(self, change_after: int = 1000) -> None:
        super().__init__(GAP_RIGHT, GAP_LEFT, change_after)


class ShortcutMazeEnv(ChangingMazeEnv):
    """The shortcut maze (Example 8.3): besides the path along the left side, a shorter one along the right side opens.

    Args:
        change_after: The number of steps after which the maze changes.
    """

    def __init__(self, change_after: int = 3000) -> None:
        super().__init__(GAP_LEFT, BOTH_GAPS, change_after)
