"""A window for replays, and whether a display can show it."""

import os
import sys
import warnings

import gymnasium as gym

from qtab._utils.extras import missing
from qtab.config import Config
from qtab.rendering.replay import make_render_env

_DISPLAY_VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")


def open_window(config: Config) -> gym.Env:
    """Returns the environment of a run with a window, which opens when the first episode starts.

    Raises:
        ModuleNotFoundError: without pygame; the message names the ``pip install``.
        ValueError: without a display, or if the environment cannot be rendered in a window.
    """
    problem = display_problem()
    if problem is not None:
        raise ValueError(f"watch needs a display ({problem}); --record FOLDER makes videos without one")
    return make_render_env(config, "human")


def is_headless() -> bool:
    """Returns whether the variables that name a display are all unset, on Linux."""
    return sys.platform == "linux" and not any(map(os.environ.get, _DISPLAY_VARIABLES))


def display_problem() -> str | None:
    """Returns the reason why a window could not be seen; None if there is a display.

    The SDL drivers ``dummy`` and ``offscreen``, which draw into memory, do not count as a display.

    Raises:
        ModuleNotFoundError: without pygame; the message names the ``pip install``.
    """
    if is_headless():
        return "neither DISPLAY nor WAYLAND_DISPLAY is set"
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # pygame's import of setuptools warns
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
