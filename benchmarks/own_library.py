"""Training on MountainCar-v0 as a shared library in C, beside the core's and Gymnasium's."""

import atexit
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import qtab
from loops import c_loop
from qtab.cli.commands import bench
from tables import Benchmark, Column, Table, relative_time, relative_to

ENV = "MountainCar-v0"
EPISODES, EPISODES_IN_PYTHON = 5000, 10
CORE, PYTHON = "qtab.train on the core's environment", "qtab.train on Gymnasium's, stepped in Python"
LIBRARY = "qtab.train on a library in C"
MANY, MANY_ON_TWO = "qtab.train_many on the library, 8 seeds, one thread", "the same on two threads"
_SETTINGS = (
    *("algorithm", "discretizer", "scale", "initial_q", "terminal_update", "learning_rate", "discount"),
    *("epsilon", "min_epsilon", "epsilon_schedule"),
)


def training() -> Table:
    """Returns the table of training with the default settings; without a C compiler, without the library."""
    config = qtab.train(ENV, episodes=1, seed=0, progress=False).config
    settings = {name: getattr(config, name) for name in _SETTINGS}
    loops: dict[str, Benchmark] = {CORE: bench.BENCHMARKS[bench.TRAIN], PYTHON: _in_python}
    if (library := build()) is not None:
        loops |= {
            LIBRARY: lambda seed: _single(library, seed, settings),
            MANY: lambda _: _many(library, 1, settings),
            MANY_ON_TWO: lambda _: _many(library, 2, settings),
        }
    column = Column("rel. time", relative_to(CORE, [*loops]), relative_time)
    columns = [column, Column("× one thread", relative_to(MANY, [MANY_ON_TWO]))]
    return Table("Training on MountainCar-v0 as one's own library", loops, columns, minimum=True)


def build() -> Path | None:
    """Compiles the library; None without a compiler that accepts the flags."""
    compiler = next(filter(None, map(shutil.which, c_loop.COMPILERS)), None)
    if compiler is None:
        return None
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    built, source = Path(folder, "mountain_car.so"), Path(__file__).with_name("mountain_car.c")
    command = [compiler, *c_loop.FLAGS, "-I", qtab.get_include(), "-o", str(built), str(source), "-lm"]
    done = subprocess.run(command, capture_output=True, check=False)  # noqa: S603 - our own file
    return built if done.returncode == 0 else None


def _in_python(seed: int) -> int:
    settings: dict[str, Any] = {"episodes": EPISODES_IN_PYTHON, "backend": "gymnasium", "progress": False}
    return int(qtab.train(ENV, seed=seed, **settings).episode_lengths.sum())


def _single(library: Path, seed: int, settings: dict[str, Any]) -> int:
    run = qtab.train(qtab.NativeEnv(library), episodes=EPISODES, seed=seed, progress=False, **settings)
    return int(run.episode_lengths.sum())


def _many(library: Path, threads: int, settings: dict[str, Any]) -> int:
    settings = {**settings, "episodes": EPISODES, "progress": False}
    return int(qtab.train_many(lambda: qtab.NativeEnv(library), 8, threads=threads, **settings).episode_lengths.sum())
