"""``qtab/BlockingMaze-v0`` and ``qtab/ShortcutMaze-v0``: mazes that change (Sutton & Barto, Examples 8.2 and 8.3)."""

from collections.abc import Sequence
from typing import Any

from qtab._utils import checks
from qtab.envs.grid_worlds import grid_world
from qtab.envs.tabular import TabularEnv

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
