"""``qtab/Racetrack-v0``: the racetrack (Sutton & Barto, 2nd ed., Exercise 5.12 and Figure 5.5)."""

from typing import Any

import gymnasium as gym

from qtab._utils import checks

TRACKS = (
    (
        "###.............F",
        "##..............F",
        "##..............F",
        "#...............F",
        "................F",
        "................F",
        "..........#######",
        ".........########",
        ".........########",
        ".........########",
        ".........########",
        ".........########",
        ".........########",
        ".........########",
        "#........########",
        "#........########",
        "#........########",
        "#........########",
        "#........########",
        "#........########",
        "#........########",
        "#........########",
        "##.......########",
        "##.......########",
        "##.......########",
        "##.......########",
        "##.......########",
        "##.......########",
        "##.......########",
        "###......########",
        "###......########",
        "###SSSSSS########",
    ),
    (
        "################...............F",
        "#############..................F",
        "############...................F",
        "###########....................F",
        "###########....................F",
        "###########....................F",
        "###########....................F",
        "############...................F",
        "#############..................F",
        "##############................##",
        "##############.............#####",
        "##############............######",
        "##############..........########",
        "##############.........#########",
        "#############..........#########",
        "############...........#########",
        "###########............#########",
        "##########.............#########",
        "#########..............#########",
        "########...............#########",
        "#######................#########",
        "######.................#########",
        "#####..................#########",
        "####...................#########",
        "###....................#########",
        "##.....................#########",
        "#......................#########",
        ".......................#########",
        ".......................#########",
        "SSSSSSSSSSSSSSSSSSSSSSS#########",
    ),
)
"""The two tracks of Figure 5.5: the track, its starting line (S) and its finish line (F)."""

VELOCITIES = 5
"""The velocities of each component: 0 to 4 cells per step, upwards and to the right."""


class RacetrackEnv(gym.Env[Any, Any]):
    """A car on a track, whose velocity each action changes by -1, 0 or +1 upwards and to the right.

    The reward is -1 per step. The episode ends when the car crosses the finish line. A car that leaves the track goes
    back to a random cell of the starting line, with a velocity of 0. The velocity must not be zero except on the
    starting line; an action that would stop the car has no effect. A path is a straight line, checked once for each
    cell of its longer side, rounded to the nearest cell.

    State ``((row * columns + column) * 5 + velocity upwards) * 5 + velocity to the right``; action
    ``3 * (1 + change upwards) + (1 + change to the right)``. Each step draws one ``np_random.random()``; a reset, and a
    car that leaves the track, one ``np_random.integers``.

    Args:
        track: The number of the track in Figure 5.5: 0 for the left one, 1 for the right one.
        failure: The probability that an action has no effect.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    def __init__(self, track: int = 0, failure: float = 0.1) -> None:
        self.layout = TRACKS[checks.integer("track", track, least=0, most=len(TRACKS) - 1)]
        self.failure = checks.real("failure", failure, 0, 1)
        rows, self.columns = len(self.layout), len(self.layout[0])
        cells = [(row, column) for row in range(rows) for column in range(self.columns)]
        self.starts = [cell for cell in cells if self.layout[cell[0]][cell[1]] == "S"]
        self.observation_space = gym.spaces.Discrete(len(cells) * VELOCITIES**2)
        self.action_space = gym.spaces.Discrete(9)
        self.cell, self.velocity = self.starts[0], (0, 0)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        """Starts an episode on a random cell of the starting line."""
        super().reset(seed=seed, options=options)
        self._start()
        return self._state(), {}

    def step(self, action: Any) -> tuple[int, float, bool, bool, dict[str, Any]]:
        """Takes a step.

        Raises:
            AssertionError: for an action outside the space.
        """
        assert self.action_space.contains(action), f"{action!r} ({type(action)}) invalid"  # noqa: S101
        up, right = self.velocity
        if not self.np_random.random() < self.failure:
            changes = int(action) // 3 - 1, int(action) % 3 - 1
            changed = _clip(up + changes[0]), _clip(right + changes[1])
            if changed != (0, 0) or self.cell in self.starts:
                up, right = changed
        reached, ground = self._move_by(up, right)
        if ground == "#":
            self._start()
        else:
            self.cell, self.velocity = reached, (up, right)
        return self._state(), -1.0, ground == "F", False, {}

    def _move_by(self, up: int, right: int) -> tuple[tuple[int, int], str]:
        """Returns the cell that the car reaches, and its letter; "#" if it leaves the track."""
        (row, column), steps = self.cell, max(up, right)
        reached = self.cell
        for step in range(1, steps + 1):
            reached = row - _rounded(step * up, steps), column + _rounded(step * right, steps)
            if reached[0] < 0 or reached[1] >= self.columns:
                return reached, "#"
            ground = self.layout[reached[0]][reached[1]]
            if ground in "#F":
                return reached, ground
        return reached, "."

    def _start(self) -> None:
        self.cell = self.starts[int(self.np_random.integers(len(self.starts)))]
        self.velocity = 0, 0

    def _state(self) -> int:
        (row, column), (up, right) = self.cell, self.velocity
        return ((row * self.columns + column) * VELOCITIES + up) * VELOCITIES + right


def _clip(velocity: int) -> int:
    return min(max(velocity, 0), VELOCITIES - 1)


def _rounded(dividend: int, divisor: int) -> int:
    """Returns a quotient rounded to the nearest integer, a half up."""
    return (2 * dividend + divisor) // (2 * divisor)
