"""``qtab.play``: the greedy agent in motion."""

import logging
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.fields import with_fields
from qtab._utils.page import page, paragraph
from qtab._utils.progress import in_notebook
from qtab._utils.shown import counted
from qtab.config.unknown import suggesting
from qtab.planning.optimum import Optimum
from qtab.rendering.agent import agent_of
from qtab.rendering.film import Film
from qtab.rendering.formats import check_video_path, save_video
from qtab.rendering.player import episode_player
from qtab.rendering.window import display_problem
from qtab.results.run import Run

_LOGGER = logging.getLogger("qtab")
MAX_FPS = 1000.0
MAX_LISTED = 3
"""The largest number of returns to list; of more, the mean is shown."""


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class Playback:
    """Episodes that an agent played, and their video, which a notebook shows."""

    env: str
    """The environment's id, or the name of its class."""
    returns: NDArray[np.float64]
    """(episodes,): the sum of rewards of each finished episode."""
    lengths: NDArray[np.int64]
    """(episodes,): the number of steps of each episode."""
    terminated: NDArray[np.bool_]
    """(episodes,): whether each episode ended in a terminal state."""
    seed: int
    """The seed of the environment."""
    film: Film = field(repr=False)
    """The pictures."""

    def __repr__(self) -> str:
        return f"<Playback of {self.summary}>"

    @property
    def summary(self) -> str:
        """The environment, the seed and the returns, in one line."""
        count = len(self.returns)
        episodes = counted(count, "episode")
        results = [
            f"return {one:.6g} in {steps:,} steps" for one, steps in zip(self.returns, self.lengths, strict=True)
        ]
        shown = ", ".join(results) if count <= MAX_LISTED else f"mean return {self.returns.mean():.2f}"
        return f"{self.env}, {episodes}, seed {self.seed}" + (f": {shown}" if shown else "")

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes the video to a file, completely or not at all.

        Args:
            path: The file, ending in ``.mp4``, ``.gif`` or ``.html``, a page with a player that needs no other file.

        Raises:
            ModuleNotFoundError: if a library is missing; the message names the ``pip install``.
            OSError: if the file cannot be written.
            ValueError: for another ending, or an environment that cannot be rendered as pictures.
        """
        target = check_video_path(path)
        save_video(self.film.frames(), target, self._page)

    def _page(self) -> str:
        return page(self.env, f"{paragraph(self.summary)}\n{self._player}")

    def _repr_html_(self) -> str:
        """HTML for notebooks: a player."""
        return self._player

    @cached_property
    def _player(self) -> str:
        return episode_player(self.film.frames(), self.summary)


@suggesting
def play(
    run: Run | Optimum,
    episodes: int = 1,
    seed: int | None = None,
    env: str | EnvSpec | gym.Env | None = None,
    *,
    window: bool | None = None,
    fps: float | None = None,
    env_kwargs: Mapping[str, Any] | None = None,
    max_episode_steps: int | None = None,
) -> Playback:
    """Shows the greedy agent in motion, rendered by Gymnasium: in a notebook as a video, in a script in a window.

    With the same seed the episodes are those of :func:`qtab.evaluate`. An :class:`~qtab.Optimum` plays its policy.
    Closing the window stops the replay; the result then holds the finished episodes.

    Args:
        run: The run, or an optimum. It is not changed.
        episodes: The number of episodes.
        seed: The seed of the environment; None draws one, which the result records.
        env: An environment other than the run's: an id, an EnvSpec, or an environment that was made with
            ``render_mode="rgb_array"``, or ``"human"`` for a window. It is not closed.
        window: Whether to show a window. None shows one outside of notebooks if there is a display.
        fps: Pictures per second; None takes the environment's ``render_fps``.
        env_kwargs: Keyword arguments for the environment's constructor; None takes those of the run, or with ``env``
            none.
        max_episode_steps: The time limit of an episode, in steps; None takes that of the run.

    Returns:
        The returns and lengths of the episodes; ``.save("agent.mp4")``, ``.gif`` or ``.html`` writes the video.

    Raises:
        gymnasium.error.DependencyNotInstalled: from Gymnasium, without the library that renders the environment.
        gymnasium.error.UnregisteredEnv: without ``env``, for a run whose environment is not registered.
        ModuleNotFoundError: for a window without pygame; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, an environment that cannot be rendered or has other spaces than the
            run's, or a window without a display.
    """
    agent = agent_of(run)
    episodes = checks.integer("episodes", episodes, least=1)
    seed = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
    seed = checks.integer("seed", seed, least=0)
    if fps is not None:
        fps = checks.real("fps", fps, 0.01, MAX_FPS)
    limit = agent.config.max_episode_steps if max_episode_steps is None else max_episode_steps
    limit = checks.count("max_episode_steps", limit, least=1)
    if window is not None:
        window = checks.boolean("window", window)
    film = Film(agent, env, env_kwargs, limit, episodes, seed, fps)
    opens, problem = _opens_window(env, window)
    played = film.show() if opens else film.record()
    if problem is not None:  # now that there are pictures to save
        _LOGGER.warning("no window is shown (%s); .save('agent.mp4') writes the video", problem)
    return Playback(agent.config.env, played.returns, played.lengths, played.terminated, seed, film)


def _opens_window(env: Any, window: bool | None) -> tuple[bool, str | None]:
    """Returns whether to open a window, and if ``window`` is None the reason why none can be opened."""
    if isinstance(env, gym.Env) and window is None:
        return env.render_mode == "human", None
    if window is False or (window is None and in_notebook()):
        return False, None
    try:
        problem = display_problem()
    except ModuleNotFoundError as error:  # pygame, which not every environment needs for its pictures
        if window:
            raise
        problem = str(error)
    if problem is None:
        return True, None
    if window:
        raise ValueError(f"window needs a display ({problem}); without one, play(..., window=False).save(path) works")
    return False, problem
