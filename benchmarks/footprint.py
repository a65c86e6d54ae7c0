"""The import time of the package and the memory of a run, each measured in a new process."""

import subprocess
import sys

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


def footprint(repeats: int = 5) -> str:
    """Returns the footprint as text; the import times are medians over ``repeats`` processes."""
    _output(_IMPORTS)  # loads the files into the disk cache
    times = [[float(seconds) for seconds in _output(_IMPORTS).split()] for _ in range(repeats)]
    gymnasium, package = np.median(times, axis=0) * 1e3
    text = f"import qtab adds {package:.1f} ms to the {gymnasium:.0f} ms of import gymnasium"
    if sys.platform == "win32":  # Windows has no resource module
        return text
    return f"{text}; a default run adds {float(_output(_MEMORY)):.1f} MB to the peak memory after the imports"


def _output(program: str) -> str:
    finished = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)  # noqa: S603
    return finished.stdout


if __name__ == "__main__":
    print(footprint())
