"""An agent's episodes as pictures or in a window: played on demand, always the same."""

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, closing, contextmanager, nullcontext
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import gymnasium as gym

from qtab._utils.progress import ProgressBar
from qtab.rendering.agent import Agent, rendered_environment
from qtab.rendering.episodes import Episodes, play_episodes
from qtab.rendering.frames import Frames, frames_per_second
from qtab.rendering.window import is_headless


@dataclass(frozen=True)
class Film:
    """An agent's episodes, whose pictures are rendered once on first use."""

    agent: Agent
    env: Any
    """None, an id, an EnvSpec or an environment, as for :func:`qtab.play`."""
    env_kwargs: Mapping[str, Any] | None
    max_episode_steps: int
    episodes: int
    seed: int
    fps: float | None
    """The pictures per second; None takes the speed of the environment."""
    max_frames: int | None = None
    """The largest number of pictures; None sets no limit."""

    def show(self) -> Episodes:
        """Plays in a window; returns the episodes that were finished before it was closed."""
        with self._environment("human") as env, _with_speed(env.unwrapped, self.fps):
            return play_episodes(self.agent, env, self.episodes, self.seed, lambda *_: not _is_window_closed())

    def record(self) -> Episodes:
        """Plays without a window, and keeps the pictures; returns the episodes."""
        return self._recorded[0]

    def frames(self) -> Frames:
        """Returns a picture of each state."""
        return self._recorded[1]

    @cached_property
    def _recorded(self) -> tuple[Episodes, Frames]:
        with _without_display(), self._environment("rgb_array") as env:
            frames = Frames(frames_per_second(env, self.fps))
            with ProgressBar(self.episodes, "episode", None, "render") as bar:

                def see(episode: int, step: int) -> bool:
                    bar.move_to(episode)
                    frames.append(env.render(), f"episode {episode + 1}, step {step}")
                    return self.max_frames is None or len(frames) < self.max_frames

                return play_episodes(self.agent, env, self.episodes, self.seed, see), frames

    def _environment(self, render_mode: str) -> AbstractContextManager[gym.Env]:
        env = rendered_environment(self.agent, self.env, self.env_kwargs, self.max_episode_steps, render_mode)
        return nullcontext(env) if isinstance(self.env, gym.Env) else closing(env)


@contextmanager
def _with_speed(env: gym.Env, fps: float | None) -> Iterator[None]:
    """Changes the speed of an environment's window, but not of its class."""
    before = env.metadata
    if fps is not None:
        env.metadata = {**before, "render_fps": fps}
    try:
        yield
    finally:
        if fps is not None:
            env.metadata = before


@contextmanager
def _without_display() -> Iterator[None]:
    """Keeps SDL from searching for a display and printing errors if there is none."""
    if not is_headless():
        yield
        return
    os.environ["SDL_VIDEODRIVER"] = "dummy"
    try:
        yield
    finally:
        os.environ.pop("SDL_VIDEODRIVER", None)


def _is_window_closed() -> bool:
    """Returns whether the user has closed the window of pygame, which Gymnasium does not check."""
    pygame: Any = sys.modules.get("pygame")
    return pygame is not None and pygame.display.get_init() and bool(pygame.event.peek(pygame.QUIT))
