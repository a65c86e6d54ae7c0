"""The environments of the playground: their descriptions, and how the page draws them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from qtab.config.preset_settings import ACROBOT
from qtab.envs.grid_worlds import DYNA_MAZE, WIND, WINDY_GRID_WORLD
from qtab.envs.metadata.goals import BEST_KNOWN_MOUNTAIN_CAR

Drawing: TypeAlias = Literal[
    "mountain_car", "cart_pole", "acrobot", "frozen_lake", "cliff", "grid", "taxi", "blackjack"
]


@dataclass(frozen=True)
class GridWorld:
    """A grid world, with the arguments of :func:`qtab.book.grid_world`."""

    layout: tuple[str, ...]
    wind: tuple[int, ...]
    step_reward: float
    goal_reward: float
    rewards: tuple[tuple[int, int, float], ...] = ()
    """Rows, columns and rewards."""


@dataclass(frozen=True)
class Entry:
    """An environment of the playground."""

    title: str
    sentence: str
    """The task of the agent, and its rewards."""
    drawing: Drawing
    env: str = ""
    """Gymnasium's id; empty for grid worlds."""
    env_kwargs: Mapping[str, Any] = field(default_factory=dict)
    best_known: float | None = None
    """The expected return of the best known policy, if the page does not compute the optimal one."""
    grids: Mapping[str, GridWorld] = field(default_factory=dict)
    """Grid worlds to start from, by title."""
    presets: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Settings in place of the package's presets, if those train longer than the page does."""
    layout: tuple[str, ...] = ()
    """The map of the states that the page shows if not all are cells of one map; a blank is no state."""
    chaotic: bool = False
    """Whether a difference in the last bit of a sine soon changes a run, so that the page's differs from Python's."""


_WINDY = GridWorld(WINDY_GRID_WORLD, WIND, step_reward=-1.0, goal_reward=-1.0)
_MAZE = GridWorld(DYNA_MAZE, (0,) * len(DYNA_MAZE[0]), step_reward=0.0, goal_reward=1.0)
_ROOMS = GridWorld(
    (
        "S....#.....",
        ".....#.....",
        "...........",
        ".....#.....",
        ".....#.....",
        "#.####.....",
        ".....###.##",
        ".....#.....",
        ".....#.....",
        "...........",
        ".....#....G",
    ),
    (0,) * 11,
    step_reward=-1.0,
    goal_reward=0.0,
)
_OPEN = GridWorld(
    (
        "........",
        "........",
        ".S....G.",
        "........",
        "........",
        "........",
    ),
    (0,) * 8,
    step_reward=-1.0,
    goal_reward=10.0,
)

# The stands of the taxi, red, green, yellow and blue, are lower-case letters: G is a goal.
_TAXI = ("r...g", ".....", ".....", ".....", "y..b.")
_BLACKJACK: Mapping[str, Any] = {
    "learning_rate": 0.05,
    "learning_rate_schedule": "linear",
    "discount": 1.0,
    "epsilon": 1.0,
    "epsilon_schedule": "linear",
    "initial_q": 0.0,
    "episodes": 50_000,
}

# Fewer tilings and episodes than in the package's preset: 16 runs fit into the memory of the page.
_ACROBOT: Mapping[str, Any] = {
    **ACROBOT,
    "tilings": 16,
    "tiles": (3, 3, 3, 3, 6, 6),
    "episodes": 1000,
}

_LAKE = "Cross the frozen lake to the goal without falling into a hole. The reward is 1 at the goal and 0 elsewhere{}"
_SLIPPERY = "; the ice is slippery, so only one move in three goes in the intended direction."
_ICE = {"is_slippery": False}

ENVIRONMENTS: Mapping[str, Entry] = {
    "MountainCar-v0": Entry(
        "Mountain car",
        "Drive an underpowered car out of a valley: it must swing back and forth to reach the flag. Each step costs 1.",
        "mountain_car",
        "MountainCar-v0",
        best_known=round(BEST_KNOWN_MOUNTAIN_CAR, 2),
    ),
    "CartPole-v1": Entry(
        "Cart pole",
        "Balance a pole on a cart by pushing the cart left or right. Each step earns 1, up to 500 steps.",
        "cart_pole",
        "CartPole-v1",
    ),
    "Acrobot-v1": Entry(
        "Acrobot",
        "Swing the end of two links above the line by a motor at the joint between them. Each step costs 1. On the map "
        "θ1 is the angle of the first link from hanging down, and θ2 that of the second link from the first.",
        "acrobot",
        "Acrobot-v1",
        presets={"learns": _ACROBOT},
        chaotic=True,
    ),
    "FrozenLake-v1": Entry("Frozen lake", _LAKE.format(_SLIPPERY), "frozen_lake", "FrozenLake-v1"),
    "FrozenLake-v1 (not slippery)": Entry(
        "Frozen lake, not slippery", _LAKE.format("."), "frozen_lake", "FrozenLake-v1", _ICE
    ),
    "FrozenLake8x8-v1": Entry("Large frozen lake", _LAKE.format(_SLIPPERY), "frozen_lake", "FrozenLake8x8-v1"),
    "FrozenLake8x8-v1 (not slippery)": Entry(
        "Large frozen lake, not slippery", _LAKE.format("."), "frozen_lake", "FrozenLake8x8-v1", _ICE
    ),
    "CliffWalking-v1": Entry(
        "Cliff walking",
        "Walk to the goal along a cliff. Each step costs 1; a fall costs 100 and leads back to the start.",
        "cliff",
        "CliffWalking-v1",
    ),
    "Taxi-v4": Entry(
        "Taxi",
        "Pick up a passenger and drive to the destination. A step costs 1, a pick-up or drop-off at a wrong place "
        "costs 10, and the ride earns 20. The map shows the states of the first ride: on the left the passenger "
        "waits, on the right the taxi has picked up the passenger.",
        "taxi",
        "Taxi-v4",
        layout=tuple(f"{row} {row}" for row in _TAXI),
    ),
    "Blackjack-v1": Entry(
        "Blackjack",
        "Get closer to 21 than the dealer without going over. Winning earns 1 and losing costs 1. On the map a row is "
        "your sum, from 21 to 4, and a column the dealer's card, from ace to 10; on the right you have a usable ace.",
        "blackjack",
        "Blackjack-v1",
        presets={"learns": _BLACKJACK},
        layout=tuple(f"{'.' * 10} {'.' * 10 if total >= 12 else ' ' * 10}" for total in range(21, 3, -1)),
    ),
    "WindyGridWorld": Entry(
        "Windy grid world",
        "Walk to the goal while the wind of each column shifts every move upwards. Each step costs 1.",
        "grid",
        grids={"Windy grid world": _WINDY},
    ),
    "grid": Entry(
        "Grid world to paint",
        "Paint walls, rewards, starts and goals: the agent learns the way through your grid.",
        "grid",
        grids={"Open field": _OPEN, "Dyna maze": _MAZE, "Four rooms": _ROOMS, "Windy grid world": _WINDY},
    ),
}
"""The environments by the key that the page uses."""
