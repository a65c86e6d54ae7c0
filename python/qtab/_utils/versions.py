"""The versions that a result was computed with, to explain differences between machines."""

import platform
from functools import cache

import gymnasium as gym
import numpy as np

from qtab._core import BUILD_PROFILE, VERSION


def versions() -> dict[str, str]:
    """Returns the versions of qtab, Gymnasium, NumPy and Python, the platform and C library, and the build profile."""
    return dict(_versions())


@cache
def _versions() -> dict[str, str]:
    libc = " ".join(platform.libc_ver()).strip()
    return {
        "qtab": VERSION,
        "gymnasium": gym.__version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}" + (f" {libc}" if libc else ""),
        "build": BUILD_PROFILE,
    }
