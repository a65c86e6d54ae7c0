"""Figure 10.1: the cost-to-go of Mountain Car as it is learned."""

from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils.progress import ProgressBar
from qtab.book.drawing import figure_of_several
from qtab.book.experiment import Outcome
from qtab.book.line import Line
from qtab.book.measured_experiment import Measured, TrainingExperiment, line_of
from qtab.book.problems import ENV, TILE_CODING, UNSPECIFIED
from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.book.setting import Setting, mean_length
from qtab.results.run import Run
from qtab.training.train import train

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FIRST_STEPS = 428
EPISODES = (12, 104, 1000, 9000)
GRID_POINTS = 40
"""The number of points of a surface along each axis."""

_SARSA = {
    **TILE_CODING,
    "algorithm": "sarsa_lambda",
    "traces": "replacing",
    "trace_decay": 0.9,
    "learning_rate": 0.5,
}
_POSITIONS = np.linspace(-1.2, 0.5, GRID_POINTS)
_VELOCITIES = np.linspace(-0.07, 0.07, GRID_POINTS)


def cost_to_go(run: Run) -> FloatArray:
    """Returns (positions, velocities): the negative of the largest action value."""
    return np.array([[-run.q_values((x, v)).max() for v in _VELOCITIES] for x in _POSITIONS])


def draw_cost_to_go(result: Result, ax: "Axes | None") -> "Axes":
    """Draws each surface, (positions, velocities), in separate 3D axes of a new figure; returns the last axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: if ``ax`` is not None.
    """
    figure = figure_of_several(result, ax, 10, 6.6)
    x, y = np.meshgrid(_POSITIONS, _VELOCITIES, indexing="ij")
    panel: Any = None
    for index, (name, surface) in enumerate(result.surfaces.items()):
        panel = figure.add_subplot(2, 3, index + 1, projection="3d")
        panel.plot_surface(x, y, surface, cmap="viridis", linewidth=0, rcount=GRID_POINTS, ccount=GRID_POINTS)
        panel.set_title(f"{name}: up to {surface.max():.0f}", fontsize="medium")
        panel.set(xlabel="position", ylabel="velocity", xticks=(-1.2, -0.5, 0.5), yticks=(-0.07, 0, 0.07))
        panel.tick_params(labelsize="x-small")
        panel.set_box_aspect(None, zoom=0.92)
    last: Axes = panel
    return last


class CostToGo(TrainingExperiment):
    """The cost-to-go of one run at five times."""

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:  # noqa: ARG002
        """Trains up to each of the five times. A shorter run equals the start of a longer one with the same seed."""
        lines: list[Line] = []
        surfaces: dict[str, FloatArray] = {}
        with ProgressBar(runs * len(self.settings), "surface", progress, self.name) as bar:
            for setting in self.settings:
                samples, truncated = [], 0
                for number in range(runs):
                    run = train(ENV, progress=False, **self.config(setting), seed=seed + number)
                    surface = cost_to_go(run)
                    surfaces.setdefault(setting.line, surface)
                    samples.append((surface.max(), surface.mean()))
                    # The setting within the first episode is truncated on purpose.
                    if run.config.max_episode_steps != FIRST_STEPS:
                        truncated += int((~run.terminated).sum())
                    bar.move_to(len(lines) * runs + len(samples))
                lines.append(line_of(setting, Measured(np.array(samples), truncated)))
        return Outcome(lines, surfaces)


EXPERIMENT = CostToGo(
    name="figure-10.1",
    title="the cost-to-go of Mountain Car",
    book=f"one run with ε = 0, shown after step {FIRST_STEPS} of the first episode and after episodes 12, 104, 1000 "
    "and 9000. According to a footnote, the data come from semi-gradient Sarsa(λ)",
    unspecified=f"λ, α and the kind of traces (0.9, 0.5/8, replacing here); {UNSPECIFIED}",
    settings=(
        # The last step bootstraps from the next state, as it would within a longer episode.
        Setting(
            f"episode 1, step {FIRST_STEPS}",
            ENV,
            {**_SARSA, "episodes": 1, "max_episode_steps": FIRST_STEPS},
            mean_length,
        ),
        *(Setting(f"episode {episode}", ENV, {**_SARSA, "episodes": episode}, mean_length) for episode in EPISODES),
    ),
    runs=1,
    x_label="over the states",
    x_words={1: "largest", 2: "mean"},
    y_label="cost-to-go",
    draw=draw_cost_to_go,
)
