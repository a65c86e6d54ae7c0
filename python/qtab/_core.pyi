"""The extension module: what Rust does. Its users are the other modules of this package."""

from collections.abc import Callable
from typing import Any, Literal, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import disjoint_base

from qtab.plan import Model, Plan, PythonEnvironment, Results

__all__ = [
    "BUILD_PROFILE",
    "Physics",
    "Stream",
    "Trainer",
    "numpy_calls_the_platform",
    "parameter_names",
    "train_many",
]

BUILD_PROFILE: Literal["debug", "release"]

def numpy_calls_the_platform() -> bool: ...
def parameter_names(model: str) -> list[str]: ...
def train_many(
    describe: Callable[[int], tuple[Model, Plan]], results: Results, threads: int, go_on: bool
) -> list[tuple[int, Exception]]: ...

@disjoint_base
class Physics:
    def __new__(cls, *_args: Any, **_kwargs: Any) -> Physics: ...
    state: Any
    def step(self, action: Any) -> tuple[NDArray[np.float32], Any, bool, bool, dict[str, Any]]: ...
    def changed(self) -> None: ...

@final
class Stream:
    def __new__(cls, bit_generator: str, seed: list[int]) -> Stream: ...
    def random(self) -> float: ...
    def integers(self, below: int) -> int: ...
    def uniform(self, low: float, high: float) -> float: ...

@final
class Trainer:
    def __new__(cls, environment: Model | PythonEnvironment, plan: Plan) -> Trainer: ...
    def advance(self, episodes: int) -> None: ...
    def episodes(self) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.bool_]]: ...
    def tables(self) -> NDArray[np.float64]: ...
    def recordings(self) -> list[tuple[Any, list[int]]]: ...
