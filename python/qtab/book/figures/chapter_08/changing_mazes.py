"""What Figures 8.4 and 8.5 share: Dyna-Q and Dyna-Q+ on a maze that changes."""

from typing import Any

from qtab.book.measures import reward_by
from qtab.book.setting import Setting

LEARNING_RATE = 0.5
"""α; the book does not state it."""
PLANNING_STEPS = 50
"""n; the book does not state it."""
TIME_WEIGHT = 1e-3
"""κ; the book does not state it."""

_DYNA: dict[str, Any] = {
    "learning_rate": LEARNING_RATE,
    "discount": 0.95,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    "planning_steps": PLANNING_STEPS,
}
UNSPECIFIED = (
    f"all settings but the mazes. Here α = {LEARNING_RATE:g}, ε = 0.1, γ = 0.95, n = {PLANNING_STEPS}, "
    f"κ = {TIME_WEIGHT:g}, ties are broken at random, and the number of runs is 100"
)


def settings(env: str, steps: int, episodes: int) -> tuple[Setting, ...]:
    """Returns the two lines: the cumulative reward by every 50 time steps.

    Args:
        env: The environment's id.
        steps: The number of time steps.
        episodes: As many as are sure to take so many steps. What comes after them does not count.
    """
    times = tuple(range(50, steps + 1, 50))
    measure, x = reward_by(times), tuple(map(float, times))
    base = {**_DYNA, "episodes": episodes}
    plus = {"algorithm": "dyna_q_plus", "time_weight": TIME_WEIGHT}
    return (
        Setting("Dyna-Q+", env, {**base, **plus}, measure, x, method="dyna_q_plus"),
        Setting("Dyna-Q", env, {**base, "algorithm": "dyna_q"}, measure, x, method="dyna_q"),
    )
