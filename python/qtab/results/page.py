"""``Run.to_html``: a run as one HTML page."""

import importlib
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import gymnasium as gym
    from gymnasium.envs.registration import EnvSpec

    from qtab.results.summary import KnownOptimum

WRITER = ""
"""The name of the module that writes the page. ``qtab`` sets it, because that module imports :class:`qtab.Run`."""


class WithPage:
    """A mixin with :meth:`to_html`."""

    def to_html(
        self,
        path: "str | os.PathLike[str]",
        *,
        optimum: "KnownOptimum | float | None" = None,
        at: Mapping[str, float] | None = None,
        layout: Sequence[str] | tuple[int, int] | None = None,
        env: "str | EnvSpec | gym.Env | None" = None,
        progress: bool | None = None,
    ) -> None:
        """Writes one self-contained HTML page, completely or not at all.

        It holds the summary, the learning curve, the values and the policy, with a slider over the snapshots if
        ``snapshots=`` kept any, an animated greedy episode if the environment can be rendered, the diagnosis if Rust
        steps the environment, and all settings. It loads nothing from the network. With 50 snapshots it takes 1 to
        3 MB; at most 50 are shown.

        Args:
            path: The file.
            optimum: A result of :func:`qtab.optimum`, or a return, to mark in the learning curve. None marks the
                optimum that the diagnosis uses, if any.
            at: For observations of more than two components, the values of the components that are not axes; see
                :func:`qtab.plots.values`.
            layout: A map for numbered states; see :func:`qtab.plots.values`.
            env: The environment to render, as for :func:`qtab.play`; None takes the run's.
            progress: Whether to show a progress bar; None shows one after a second.

        Raises:
            ModuleNotFoundError: without matplotlib or Pillow; the message names the ``pip install``.
            OSError: if the file cannot be written.
            TypeError: for an argument of the wrong type.
            ValueError: for an argument that does not fit the environment.
        """
        write_page: Any = importlib.import_module(WRITER).write_page
        write_page(self, path, optimum=optimum, at=at, layout=layout, env=env, progress=progress)
