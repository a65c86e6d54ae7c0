"""Figure 5.1: values of the blackjack policy that sticks on 20 and 21, by Monte Carlo prediction."""

from typing import TYPE_CHECKING, Any

from qtab.book.drawing.blackjack import USABLE, draw_blackjack
from qtab.book.experiment import Outcome
from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import blackjack, root_value_error
from qtab.book.result import Result
from qtab.envs.registry import UNLIMITED_MAX_EPISODE_STEPS
from qtab.prediction.estimate import estimate_values

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_POINTS = (10_000, 500_000)
_ARGUMENTS: dict[str, Any] = {
    "method": "monte_carlo",
    "first_visit": True,
    "episodes": _POINTS[-1],
    "record": _POINTS,
}


def draw_values(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the values after both numbers of episodes in a new figure, and returns the last axes."""
    titles = [f"after {count:,} episodes" for count in _POINTS]
    values = {title: {ace: result.surfaces[f"{ace}, {title}"] for ace in USABLE} for title in titles}
    return draw_blackjack(result, ax, values, {})


class BlackjackValues(PredictionExperiment):
    """Errors of the estimates of all runs, with the values of the first run as surfaces."""

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:
        """Estimates the values."""
        outcome = super()._run(runs, seed, threads, progress)
        task = blackjack()
        # With the default limit given, there is no note that the game has none.
        limit = UNLIMITED_MAX_EPISODE_STEPS
        first = estimate_values(task.env, task.policy, seeds=[seed], max_episode_steps=limit, **_ARGUMENTS)
        surfaces = {
            f"{name}, after {count:,} episodes": first.values_after(point)[0, 12:22, 1:11, ace]
            for ace, name in ((1, USABLE[0]), (0, USABLE[1]))
            for point, count in enumerate(_POINTS)
        }
        return outcome._replace(surfaces=surfaces)


EXPERIMENT = BlackjackValues(
    name="figure-5.1",
    title="Monte Carlo values of a blackjack policy",
    book="the policy sticks on 20 and 21; first-visit Monte Carlo; values after 10,000 and 500,000 episodes; one run",
    unspecified="",
    settings=(PredictionSetting("error against the exact values", blackjack, _ARGUMENTS, root_value_error, _POINTS),),
    runs=1,
    x_label="episodes",
    y_label="RMS error by visits",
    draw=draw_values,
)
