"""The article's training loop in C, if a compiler is installed."""

import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-O3", "-march=native", "-ffp-contract=off", "-shared", "-fPIC")
"""Contraction would fuse multiplications and additions, which Gymnasium and NumPy do not do."""


def build() -> Any:
    """Compiles the loop and returns it as a function; None without a compiler that accepts the flags."""
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        built = Path(folder, "article.so")
        command = [compiler, *FLAGS, "-o", str(built), str(Path(__file__).with_name("article.c")), "-lm"]
        if subprocess.run(command, capture_output=True, check=False).returncode != 0:  # noqa: S603 - our own file
            return None
        function = ctypes.CDLL(str(built)).q_learning
    function.restype = ctypes.c_int64
    function.argtypes = [*[ctypes.c_void_p] * 3, ctypes.c_int64, *[ctypes.c_double] * 4]
    return function


def train(q_learning: Any, seed: int, episodes: int) -> tuple[NDArray[np.float64], int]:
    """Trains with the article's settings, and returns the Q table, (19, 15, 3), and the number of steps."""
    seeds = np.random.SeedSequence(seed)
    env, agent = np.random.default_rng(seeds), np.random.default_rng(seeds.spawn(1)[0])
    q = agent.uniform(-1.0, 1.0, (19, 15, 3))
    streams = (rng.bit_generator.ctypes.bit_generator for rng in (env, agent))
    return q, q_learning(q.ctypes.data, *streams, episodes, 0.2, 0.9, 0.8, 0.0)
