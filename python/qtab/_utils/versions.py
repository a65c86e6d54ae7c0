"""The software versions of a result, to explain differences between machines."""

import platform
import re
from functools import cache

import gymnasium as gym
import numpy as np

from qtab._core import BUILD_PROFILE, VERSION


def versions() -> dict[str, str]:
    """Returns the versions of qtab, Gymnasium, NumPy and Python, the platform, the C library and the build profile."""
    return dict(_versions())


def distribution_version(version: str = VERSION) -> str:
    """Returns the version of this package as in its metadata: ``1.2.3rc1``, which Cargo spells ``1.2.3-rc.1``."""
    return re.sub(r"-(?:(a)lpha|(b)eta|(rc))\.?(\d+)$", r"\1\2\3\4", version)


@cache
def _versions() -> dict[str, str]:
    libc = " ".join(platform.libc_ver()).strip()
    return {
        "qtab": distribution_version(),
        "gymnasium": gym.__version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}" + (f" {libc}" if libc else ""),
        "build": BUILD_PROFILE,
    }
