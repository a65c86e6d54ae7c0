"""What the package costs beside its speed: the time of its import, the memory of a run; each in a fresh process."""

import subprocess
import sys
from dataclasses import dataclass

import numpy as np

_IMPORTS = """
import time
began = time.perf_counter()
import gymnasium
between = time.perf_counter()
import qtab
print(between - began, time.perf_counter() - between)
"""

# A first short run does the imports that wait for their use. The peak is in bytes on macOS, in kibibytes elsewhere.
_MEMORY = """
import resource, sys
import qtab
def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 if sys.platform == "darwin" else 1 / 1024)
qtab.train("MountainCar-v0", episodes=1, seed=0)
before = peak()
qtab.train("MountainCar-v0", seed=0)
print((peak() - before) / 1e6)
"""


@dataclass(frozen=True)
class Footprint:
    """Time of import and memory."""

    gymnasium_milliseconds: float
    """What ``import gymnasium`` takes."""
    qtab_milliseconds: float
    """What ``import qtab`` adds to it."""
    megabytes: float | None
    """The peak memory of a default run over the imports; None where the platform does not tell."""


def footprint(repeats: int = 5) -> Footprint:
    """Measures in fresh processes; the imports' figures are medians of so many."""
    _output(_IMPORTS)  # fills the disk's cache
    seconds = np.median([[float(part) for part in _output(_IMPORTS).split()] for _ in range(repeats)], axis=0)
    megabytes = None if sys.platform == "win32" else float(_output(_MEMORY))
    return Footprint(float(seconds[0] * 1e3), float(seconds[1] * 1e3), megabytes)


def _output(program: str) -> str:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)  # noqa: S603
    return done.stdout
