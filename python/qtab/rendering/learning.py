"""Pictures of a run's tables over its snapshots, with one scale of colors."""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.progress import ProgressBar
from qtab._utils.shown import counted
from qtab.plots.arrangements import Raster, arrange
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.parts.axes import new_figure
from qtab.plots.parts.panels import color_bar, draw_heat_map
from qtab.plots.parts.subject import Subject, subject_of
from qtab.plots.policy import policy
from qtab.plots.values import common_norm, value_label, value_text
from qtab.rendering.frames import Frames
from qtab.results.run import Run

PANELS = ("values", "policy")
DOTS_PER_INCH = 90


def runs_at_snapshots(run: Run) -> list[tuple[int, Run]]:
    """Returns the number of finished episodes at each snapshot, and the run with the tables of that time.

    Raises:
        ValueError: without snapshots.
    """
    if run.snapshots is None or not len(run.snapshots):
        raise ValueError("run must have snapshots: qtab.train(..., snapshots=50) keeps them")
    # With one number as the initial value, a table shows what was learned by then; else the visits of all episodes do.
    visits = None if isinstance(run.config.initial_q, int | float) else run.visits
    tables = zip(run.snapshots.episodes.tolist(), run.snapshots.tables, strict=True)
    return [(done, dataclasses.replace(run, tables=table, visits=visits)) for done, table in tables]


def after_episodes(done: int) -> str:
    """Returns the point in time of a snapshot in words."""
    return f"after {counted(done, 'episode')}"


def draw_learning(
    states: Sequence[tuple[int, Run]],
    panels: Sequence[str],
    fps: float,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    titles: Sequence[str] | None = None,
    progress: bool | None = None,
) -> Frames:
    """Returns a picture of each state, with a panel for the values, for the policy, or for each of them.

    Args:
        states: The result of :func:`runs_at_snapshots`.
        panels: The panels to draw, of :data:`PANELS`.
        fps: The number of pictures per second.
        at: The components of the observation that are held fixed; see :func:`qtab.plots.values`.
        layout: A map for numbered states; see :func:`qtab.plots.values`.
        titles: The title of each panel, above the number of episodes; None names the run.
        progress: Whether to show a progress bar; None shows one after a second.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for ``at`` or ``layout`` of the wrong type.
        ValueError: if they do not fit the environment.
    """
    subjects = [subject_of("run", run) for _, run in states]
    raster = arrange(subjects[-1], at, layout)
    titles = [subjects[-1].name] * len(panels) if titles is None else titles
    width, height = raster.size
    figure = new_figure(width * len(panels) * (0.85 if len(panels) > 1 else 1), height)
    from matplotlib import rc_context  # after the figure, whose error names the extra
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.set_dpi(DOTS_PER_INCH)
    canvas: Any = FigureCanvasAgg(figure)
    frames = Frames(fps)
    painter = _Painter(figure, raster, subjects, panels, at, layout)
    # With a fixed height of the titles, matplotlib does not measure all labels for each picture.
    with rc_context({"axes.titley": 1.0}), ProgressBar(len(states), "snapshot", progress, "draw") as bar:
        # The last picture, which shows the most, determines the layout of all.
        painter.draw(len(states) - 1, _below(titles, states[-1][0]))
        canvas.draw()
        figure.set_layout_engine("none")
        for index, (done, _) in enumerate(states):
            painter.draw(index, _below(titles, done))
            canvas.draw()
            frames.append(np.asarray(canvas.buffer_rgba())[..., :3].copy(), after_episodes(done))
            bar.move_to(index + 1)
    return frames


def _below(titles: Sequence[str], done: int) -> list[str]:
    return [f"{title}\n{after_episodes(done)}" for title in titles]


class _Painter:
    """Draws the panels of one state on the same axes."""

    def __init__(
        self,
        figure: Any,
        raster: Raster,
        subjects: Sequence[Subject],
        panels: Sequence[str],
        at: Mapping[str, float] | None,
        layout: Layout | None,
    ) -> None:
        self.raster, self.subjects, self.panels = raster, subjects, panels
        self.at, self.layout = at, layout
        self.bar: Any = None
        self.axes = list(figure.subplots(1, len(panels), squeeze=False)[0])
        self.grids: list[NDArray[np.float64]] = []
        if "values" in panels:
            self.grids = [subject.state_values(raster.rows) for subject in subjects]
            self.norm = common_norm(self.grids)

    def draw(self, index: int, titles: Sequence[str]) -> None:
        """Draws the state with an index in place of the previous one."""
        for ax, panel, title in zip(self.axes, self.panels, titles, strict=True):
            self._clear(ax)
            if panel == "values":
                image = draw_heat_map(ax, self.raster, self.grids[index], self.norm, title, value_text)
                if self.bar is None:
                    self.bar = color_bar([ax], self.raster, image, value_label(self.subjects)).ax
            else:
                source: Any = self.subjects[index].source
                policy(source, ax, at=self.at, layout=self.layout, title=title)

    def _clear(self, ax: Any) -> None:
        """Removes the drawing; the axes, their ticks and the color bar stay, which saves a third of the time."""
        legend = ax.get_legend()
        drawn = [*ax.collections, *ax.lines, *ax.texts, *ax.patches, *ax.images, *ax.child_axes, legend]
        for artist in drawn:
            if artist is not None and artist is not self.bar:
                artist.remove()
