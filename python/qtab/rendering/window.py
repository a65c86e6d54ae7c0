"""The screen: whether there is one, and an environment that draws on it."""

import os
import sys
import warnings

import gymnasium as gym

from qtab._utils.extras import missing
from qtab.config import Config
from qtab.rendering.replay import make_render_env

_SAYS_WHERE = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")


def open_window(config: Config) -> gym.Env:
    """Returns the environment with its window, which opens with the first episode.

    Raises:
        ModuleNotFoundError: without pygame; it names the ``pip install``.
        ValueError: without a display, or if the environment has no window.
    """
    why_not = no_display()
    if why_not is not None:
        raise ValueError(f"watch needs a display ({why_not}); --record DIR makes videos without one")
    return make_render_env(config, "human")


def headless() -> bool:
    """Whether nothing says where a window could open."""
    return sys.platform == "linux" and not any(map(os.environ.get, _SAYS_WHERE))


def no_display() -> str | None:
    """Returns why nobody would see a window; None where somebody would.

    A driver that draws nowhere (SDL_VIDEODRIVER=dummy or offscreen) counts as no display.
    """
    if headless():
        return "neither DISPLAY nor WAYLAND_DISPLAY is set"
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # pygame's own, of setuptools
            import pygame
    except ModuleNotFoundError as error:
        raise missing(error, "video") from None
    try:
        pygame.display.init()
        driver = pygame.display.get_driver()
    except pygame.error as error:
        return str(error)
    finally:
        pygame.display.quit()
    return f"SDL draws to {driver!r}" if driver in ("dummy", "offscreen") else None
