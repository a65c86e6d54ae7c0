"""The processor time of a call of ``qtab.train`` in a new process, before and after a class was compiled."""

import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from loops import numba_loops
from tables import line, number

CORE = "MountainCar-v0 of the package"
FIRST, CACHED = "a FunctionalEnv, compiled and compared with Python", "the FunctionalEnv again, its code loaded"
ORDINARY_FIRST, ORDINARY_CACHED = (
    "an ordinary class, compiled and compared",
    "the ordinary class again, its code loaded",
)

_PROGRAM = """
import sys, time
import qtab, own_cars
env = getattr(own_cars, sys.argv[1])() if sys.argv[1:] else "MountainCar-v0"
backend = "numba" if sys.argv[1:] else "rust"
started = time.process_time()  # other programs do not change it
qtab.train(env, seed=0, episodes=1, backend=backend, **own_cars.SETTINGS)
print(time.process_time() - started)
"""


@dataclass(frozen=True)
class StartTable:
    """Programs that measure themselves, in the same rounds."""

    title: str
    benchmarks: Mapping[str, Callable[[Path], float]]
    """Functions from the folder of a round to seconds of processor time, by name."""

    def measured(self, seconds: float, rounds: int | None) -> str:
        """Runs the programs for about ``seconds``, or in ``rounds`` rounds, and returns the table of the minima."""
        found: list[list[float]] = []
        began = time.perf_counter()
        while len(found) < (rounds or 3) or (rounds is None and time.perf_counter() < began + seconds):
            with tempfile.TemporaryDirectory() as folder:
                shutil.copy(Path(__file__).with_name("own_cars.py"), folder)  # its code is stored in this folder
                found.append([benchmark(Path(folder)) for benchmark in self.benchmarks.values()])
        least = map(min, zip(*found, strict=True))
        rows = [line(name, number(row)) for name, row in zip(self.benchmarks, least, strict=True)]
        return "\n".join([line(self.title, "CPU seconds"), *rows])


def starting() -> StartTable:
    """Returns the table of the first runs; without Numba, only of the package's environment."""
    programs: dict[str, Callable[[Path], float]] = {CORE: _run}
    if numba_loops.compiles():
        programs |= {FIRST: _run_functions, CACHED: _run_functions}
        programs |= {ORDINARY_FIRST: _run_class, ORDINARY_CACHED: _run_class}
    return StartTable("One episode in a new process, after the imports", programs)


def _run(folder: Path, *maker: str) -> float:
    program = [sys.executable, "-c", _PROGRAM, *maker]
    done = subprocess.run(program, cwd=folder, capture_output=True, text=True, check=True)  # noqa: S603
    return float(done.stdout)


def _run_functions(folder: Path) -> float:
    return _run(folder, "limited")


def _run_class(folder: Path) -> float:
    return _run(folder, "limited_class")
