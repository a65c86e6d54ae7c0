"""The settings of Figures 8.4 and 8.5: Dyna-Q and Dyna-Q+ on a maze that changes."""

from typing import Any

from qtab.book.setting import Setting, reward_by
from qtab.config.preset_settings import CHANGING_MAZE

_DYNA: dict[str, Any] = {
    name: value for name, value in CHANGING_MAZE.items() if name not in ("algorithm", "time_weight", "episodes")
}
UNSPECIFIED = (
    f"all settings but the mazes. Here α = {_DYNA['learning_rate']:g}, ε = 0.1, γ = 0.95, "
    f"n = {_DYNA['planning_steps']}, κ = {CHANGING_MAZE['time_weight']:g}, ties are broken at random, and the number "
    "of runs is 100"
)


def settings(env: str, steps: int, episodes: int) -> tuple[Setting, ...]:
    """Returns the settings of the two lines: the cumulative reward every 50 time steps.

    Args:
        env: The environment's id.
        steps: The number of time steps.
        episodes: The number of episodes, which must suffice for ``steps``. Later steps do not count.
    """
    times = tuple(range(50, steps + 1, 50))
    measure, x = reward_by(times), tuple(map(float, times))
    base = {**_DYNA, "episodes": episodes}
    plus = {"algorithm": "dyna_q_plus", "time_weight": CHANGING_MAZE["time_weight"]}
    return (
        Setting("Dyna-Q+", env, {**base, **plus}, measure, x, method="dyna_q_plus"),
        Setting("Dyna-Q", env, {**base, "algorithm": "dyna_q"}, measure, x, method="dyna_q"),
    )
