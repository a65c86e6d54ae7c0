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
    from qtab import designs, plots, stats
    from qtab.config import Config
    from qtab.envs.tabular import TabularEnv
    from qtab.evaluation import Evaluation, evaluate
    from qtab.many import train_many
    from qtab.planning import Gap, Optimum, optimum
    from qtab.plotting import plot
    from qtab.preset import presets
    from qtab.run import Recording, Run
    from qtab.runs import Runs
    from qtab.storage import load
    from qtab.sweeping import StoreError, Sweep, SweepProgress, load_sweep, sweep
    from qtab.training import train
    from qtab.verification import Verification, verify

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

_HOME = {
    "Config": "config",
    "Evaluation": "evaluation",
    "Gap": "planning",
    "Optimum": "planning",
    "Progress": "callbacks",
    "Recording": "run",
    "Run": "run",
    "Runs": "runs",
    "StoreError": "sweeping",
    "Sweep": "sweeping",
    "SweepProgress": "sweeping",
    "TabularEnv": "envs.tabular",
    "Verification": "verification",
    "evaluate": "evaluation",
    "load": "storage",
    "load_sweep": "sweeping",
    "optimum": "planning",
    "plot": "plotting",
    "presets": "preset",
    "sweep": "sweeping",
    "train": "training",
    "train_many": "many",
    "verify": "verification",
}

_MODULES = ("designs", "plots", "stats")


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("qtab")
    if name in _MODULES:
        return import_module(f"qtab.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'qtab' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"qtab.{_HOME[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


_register()
