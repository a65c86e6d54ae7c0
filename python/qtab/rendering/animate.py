"""``qtab.animate``: pictures of a run's values or policy over its snapshots."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.fields import with_fields
from qtab._utils.page import page
from qtab.plots.arrangements.grid_map import Layout
from qtab.rendering.formats import check_video_path, png_uris, save_video
from qtab.rendering.frames import Frames
from qtab.rendering.learning import PANELS, draw_learning, runs_at_snapshots
from qtab.rendering.play import MAX_FPS
from qtab.rendering.player import slider
from qtab.results.run import Run


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class Animation:
    """Pictures of a run's tables over its snapshots, which a notebook shows with a slider."""

    env: str
    """The environment's id."""
    what: str
    """``"values"`` or ``"policy"``."""
    episodes: NDArray[np.int64]
    """(n,): the number of finished episodes at each picture."""
    frames: Frames = field(repr=False)
    """The pictures."""

    def __len__(self) -> int:
        return len(self.episodes)

    def __repr__(self) -> str:
        return f"<Animation of the {self.what} of {self.env}, {len(self)} pictures>"

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes the animation to a file, completely or not at all.

        Args:
            path: The file, ending in ``.gif``, ``.mp4`` or ``.html``, a page with a slider that needs no other file.

        Raises:
            ModuleNotFoundError: if a library is missing; the message names the ``pip install``.
            OSError: if the file cannot be written.
            ValueError: for another ending.
        """
        target = check_video_path(path)
        save_video(self.frames, target, lambda: page(self.env, self._repr_html_()))

    def _repr_html_(self) -> str:
        """HTML for notebooks: the pictures with a slider."""
        noun = "Values of the states" if self.what == "values" else "Greedy policy"
        return slider(list(png_uris(self.frames)), self.frames.labels, self.frames.fps, f"{noun} of {self.env}")


def animate(
    run: Run,
    path: "str | os.PathLike[str] | None" = None,
    *,
    what: Literal["values", "policy"] = "values",
    fps: float = 5.0,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    title: str | None = None,
    progress: bool | None = None,
) -> Animation:
    """Draws the values or the policy of a run at each of its snapshots, with one scale of colors.

    Args:
        run: A run trained with ``snapshots=``.
        path: A file to write, ending in ``.gif``, ``.mp4`` or ``.html``; None writes none. A notebook shows the result.
        what: ``"values"``, as :func:`qtab.plots.values` draws them, or ``"policy"``, as :func:`qtab.plots.policy` does.
        fps: Snapshots per second.
        at: For observations of more than two components, the values of those that are not axes; see
            :func:`qtab.plots.values`.
        layout: A map for numbered states; see :func:`qtab.plots.values`.
        title: The title, above the number of episodes; None names the environment, the algorithm and the seed.
        progress: Whether to show a progress bar; None shows one after a second.

    Returns:
        The pictures; ``.save(path)`` writes them in another format.

    Raises:
        ModuleNotFoundError: without matplotlib, Pillow or, for ``.mp4``, ffmpeg; the message names the
            ``pip install``.
        OSError: if the file cannot be written.
        TypeError: for an argument of the wrong type.
        ValueError: for a run without snapshots, another ending, or an argument that does not fit the environment.
    """
    checks.instance("run", run, Run)
    checks.choice("what", what, PANELS)
    fps = checks.real("fps", fps, 0.01, MAX_FPS)
    if title is not None:
        checks.instance("title", title, str)
    target = None if path is None else check_video_path(path)
    states = runs_at_snapshots(run)
    titles = None if title is None else [title]
    frames = draw_learning(states, [what], fps, at, layout, titles, progress)
    animation = Animation(run.config.env, what, np.array([done for done, _ in states], np.int64), frames)
    if target is not None:
        animation.save(target)
    return animation
