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
    from qtab import book, plots, stats
    from qtab.config import Config
    from qtab.config.presets import presets
    from qtab.envs.tabular import TabularEnv
    from qtab.planning.gap import Gap
    from qtab.planning.optimum import Optimum
    from qtab.planning.solve import optimum
    from qtab.plots.run import plot
    from qtab.results.run import Recording, Run
    from qtab.results.runs import Runs
    from qtab.results.storage import load
    from qtab.sweeps import designs
    from qtab.sweeps.database import StoreError
    from qtab.sweeps.results import Sweep, load_sweep
    from qtab.sweeps.sweep import SweepProgress, sweep
    from qtab.training.callbacks import Progress
    from qtab.training.evaluate import Evaluation, evaluate
    from qtab.training.train import train
    from qtab.training.train_many import train_many
    from qtab.training.verify import Verification, verify

    __version__: str

__all__ = [
    "Config",
    "Evaluation",
    "Gap",
    "Optimum",
    "Progress",
    "Recording",
    "Run",
    "Runs",
    "StoreError",
    "Sweep",
    "SweepProgress",
    "TabularEnv",
    "Verification",
    "book",
    "designs",
    "evaluate",
    "load",
    "load_sweep",
    "optimum",
    "plot",
    "plots",
    "presets",
    "stats",
    "sweep",
    "train",
    "train_many",
    "verify",
]

_PUBLIC = {
    "Config": "config",
    "Evaluation": "training.evaluate",
    "Gap": "planning.gap",
    "Optimum": "planning.optimum",
    "Progress": "training.callbacks",
    "Recording": "results.run",
    "Run": "results.run",
    "Runs": "results.runs",
    "StoreError": "sweeps.database",
    "Sweep": "sweeps.results",
    "SweepProgress": "sweeps.sweep",
    "TabularEnv": "envs.tabular",
    "Verification": "training.verify",
    "evaluate": "training.evaluate",
    "load": "results.storage",
    "load_sweep": "sweeps.results",
    "optimum": "planning.solve",
    "plot": "plots.run",
    "presets": "config.presets",
    "sweep": "sweeps.sweep",
    "train": "training.train",
    "train_many": "training.train_many",
    "verify": "training.verify",
}

_MODULES = {"book": "book", "designs": "sweeps.designs", "plots": "plots", "stats": "stats"}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("qtab")
    if name in _MODULES:
        return import_module(f"qtab.{_MODULES[name]}")
    if name not in _PUBLIC:
        raise AttributeError(f"module 'qtab' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"qtab.{_PUBLIC[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


_register()
