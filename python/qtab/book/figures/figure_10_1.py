"""Figure 10.1: the cost-to-go of Mountain Car while it is learned."""

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils.progress import ProgressBar
from qtab.book.experiment import Experiment, Line, Numbers, Result, Setting, line
from qtab.book.measures import mean_length
from qtab.book.mountain_car import ENV, OPEN, TILE_CODING
from qtab.results.run import Run
from qtab.training.train import train

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FIRST_STEPS = 428
EPISODES = (12, 104, 1000, 9000)
POINTS = 40
"""Of the surfaces, along each axis."""

_SARSA = {
    **TILE_CODING,
    "algorithm": "sarsa_lambda",
    "traces": "replacing",
    "trace_decay": 0.9,
    "learning_rate": 0.5,
}
_POSITIONS = np.linspace(-1.2, 0.5, POINTS)
_VELOCITIES = np.linspace(-0.07, 0.07, POINTS)


def cost_to_go(run: Run) -> Numbers:
    """Returns (positions, velocities): the negative of the largest action value."""
    return np.array([[-run.q_values((x, v)).max() for v in _VELOCITIES] for x in _POSITIONS])


@dataclass(frozen=True)
class CostToGo(Experiment):
    """One run, looked at five times."""

    def run(
        self, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
    ) -> Result:
        """Trains to each of the five moments: a run is the beginning of every longer one with its seed."""
        count, seed, _ = self.check(runs, seed, threads)
        began = time.perf_counter()
        lines: list[Line] = []
        first: dict[str, Numbers] = {}
        with ProgressBar(count * len(self.settings), "surface", progress, self.name) as shown:
            for setting in self.settings:
                samples, capped = [], 0
                for number in range(count):
                    run = train(ENV, progress=False, **self.config(setting), seed=seed + number)
                    surface = cost_to_go(run)
                    first.setdefault(setting.line, surface)
                    samples.append((surface.max(), surface.mean()))
                    # The first episode is left on purpose.
                    capped += 0 if run.config.max_episode_steps == FIRST_STEPS else int((~run.terminated).sum())
                    shown.move_to(len(lines) * count + len(samples))
                lines.append(line(setting, np.array(samples), capped, 0))
        return Result(self, tuple(lines), count, seed, time.perf_counter() - began, first)

    def draw(self, result: Result, ax: "Axes | None" = None) -> "Axes":
        """Draws the five surfaces side by side, each with its own axes; ``ax`` must be None.

        Raises:
            ValueError: if it is not.
        """
        from qtab.book.drawing import draw_surfaces

        if ax is not None:
            raise ValueError("ax must be None for figure-10.1, which has five of its own")
        surfaces: dict[str, Any] = result.extra
        return draw_surfaces(result, _POSITIONS, _VELOCITIES, surfaces)


EXPERIMENT = CostToGo(
    name="figure-10.1",
    title="the cost-to-go of Mountain Car",
    book=f"one run with ε = 0, looked at after step {FIRST_STEPS} of the first episode and after episodes 12, 104, "
    "1000 and 9000. By a footnote its data come from semi-gradient Sarsa(λ)",
    silent=f"λ, α and the kind of traces (0.9, 0.5/8, replacing here); {OPEN}",
    settings=(
        # A time-out learns from the last step as if the episode went on, which it did.
        Setting(
            f"episode 1, step {FIRST_STEPS}",
            ENV,
            {**_SARSA, "episodes": 1, "max_episode_steps": FIRST_STEPS},
            mean_length,
        ),
        *(Setting(f"episode {episode}", ENV, {**_SARSA, "episodes": episode}, mean_length) for episode in EPISODES),
    ),
    runs=1,
    x="1: largest, 2: mean",
    y="cost-to-go",
)
