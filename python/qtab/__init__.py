"""Tabular reinforcement learning on Gymnasium environments, from Rust, with Gymnasium's and NumPy's numbers to the bit.

    import qtab

    run = qtab.train("MountainCar-v0", seed=0)
    run.mean_returns(100)

Importing it registers the environments ``qtab/…`` with Gymnasium, and no more: what is named below loads when it is
first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from qtab.envs import register as _register

if TYPE_CHECKING:
    from qtab.config import Config
    from qtab.envs.tabular import TabularEnv
    from qtab.evaluation import Evaluation, evaluate
    from qtab.plotting import plot
    from qtab.preset import presets
    from qtab.run import Recording, Run
    from qtab.storage import load
    from qtab.training import Progress, train
    from qtab.verification import Verification, verify

    __version__: str

__all__ = [
    "Config",
    "Evaluation",
    "Progress",
    "Recording",
    "Run",
    "TabularEnv",
    "Verification",
    "evaluate",
    "load",
    "plot",
    "presets",
    "train",
    "verify",
]

_HOME = {
    "Config": "config",
    "Evaluation": "evaluation",
    "Progress": "training",
    "Recording": "run",
    "Run": "run",
    "TabularEnv": "envs.tabular",
    "Verification": "verification",
    "evaluate": "evaluation",
    "load": "storage",
    "plot": "plotting",
    "presets": "preset",
    "train": "training",
    "verify": "verification",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("qtab")
    if name not in _HOME:
        raise AttributeError(f"module 'qtab' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"qtab.{_HOME[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


_register()
