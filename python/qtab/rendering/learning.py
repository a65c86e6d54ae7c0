"""Pictures of a run's tables over its snapshots, with one scale of colors."""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from qtab._utils.progress import ProgressBar
from qtab._utils.shown import counted
from qtab.plots.arrangements import arrange
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.parts.axes import new_figure
from qtab.plots.parts.panels import color_bar, draw_heat_map
from qtab.plots.parts.subject import subject_of
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
    axes: Any = figure.subplots(1, len(panels), squeeze=False)[0]
    grids = [subject.state_values(raster.rows) for subject in subjects] if "values" in panels else []
    norm, color_bars = common_norm(grids), list[Any]()

    def draw(index: int) -> None:
        """Draws a state in place of the previous one: the axes, their ticks and the color bar stay, to save time."""
        for ax, panel, title in zip(axes, panels, titles, strict=True):
            drawn = [*ax.collections, *ax.lines, *ax.texts, *ax.patches, *ax.images, *ax.child_axes, ax.get_legend()]
            for artist in drawn:
                if artist is not None and artist not in color_bars:
                    artist.remove()
            heading = f"{title}\n{after_episodes(states[index][0])}"
            if panel == "policy":
                source: Any = subjects[index].source
                policy(source, ax, at=at, layout=layout, title=heading)
                continue
            image = draw_heat_map(ax, raster, grids[index], norm, heading, value_text)
            if not color_bars:
                color_bars.append(color_bar([ax], raster, image, value_label(subjects)).ax)
        canvas.draw()

    # With a fixed height of the titles, matplotlib does not measure all labels for each picture.
    with rc_context({"axes.titley": 1.0}), ProgressBar(len(states), "snapshot", progress, "draw") as bar:
        # The last picture, which shows the most, determines the layout of all.
        draw(len(states) - 1)
        figure.set_layout_engine("none")
        for index, (done, _) in enumerate(states):
            draw(index)
            frames.append(np.asarray(canvas.buffer_rgba())[..., :3].copy(), after_episodes(done))
            bar.move_to(index + 1)
    return frames
