"""The versions that a result was computed with, to explain differences between machines."""

import platform
from functools import cache
from importlib.metadata import version

import numpy as np


def versions() -> dict[str, str]:
    """Returns the versions of qtab, Gymnasium, NumPy and Python, the platform and C library, and the build profile."""
    return dict(_versions())


@cache  # reading the metadata takes as long as a short run
def _versions() -> dict[str, str]:
    from qtab._core import BUILD_PROFILE

    libc = " ".join(platform.libc_ver()).strip()
    return {
        "qtab": version("qtab"),
        "gymnasium": version("gymnasium"),
        "numpy": np.__version__,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}" + (f" {libc}" if libc else ""),
        "build": BUILD_PROFILE,
    }
