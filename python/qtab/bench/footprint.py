"""The import time of the package and the memory of a run, each measured in a new process."""

import subprocess
import sys
from dataclasses import dataclass

import numpy as np

_IMPORTS = """
import time
started = time.perf_counter()
import gymnasium
imported = time.perf_counter()
import qtab
print(imported - started, time.perf_counter() - imported)
"""

# A short run first loads the modules that are imported on first use. ru_maxrss is in bytes on macOS, else in KiB.
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
    """Import times and memory."""

    gymnasium_milliseconds: float
    """The time of ``import gymnasium``."""
    qtab_milliseconds: float
    """The time that ``import qtab`` adds to it."""
    megabytes: float | None
    """The peak memory that a run with default settings adds to the imports; None where it cannot be measured."""


def footprint(repeats: int = 5) -> Footprint:
    """Measures the footprint; the import times are medians over ``repeats`` processes."""
    _output(_IMPORTS)  # loads the files into the disk cache
    seconds = np.median([[float(part) for part in _output(_IMPORTS).split()] for _ in range(repeats)], axis=0)
    megabytes = None if sys.platform == "win32" else float(_output(_MEMORY))
    return Footprint(float(seconds[0] * 1e3), float(seconds[1] * 1e3), megabytes)


def _output(program: str) -> str:
    finished = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)  # noqa: S603
    return finished.stdout
