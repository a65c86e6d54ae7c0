"""Callbacks for :func:`qtab.train`: they save, log, evaluate, stop and draw, and do not change the run's numbers.

    from qtab.callbacks import Checkpoint, CSVLogger, StopAtReturn

    qtab.train("MountainCar-v0", callback=[Checkpoint("run.npz"), CSVLogger("log.csv"), StopAtReturn(-110)])

Each class is in a separate file, which loads on first use.
"""

import importlib as _importlib
from typing import TYPE_CHECKING

_MODULES = {
    "BaseCallback": "qtab.training.callbacks",
    "CSVLogger": "qtab.callbacks.csv_logger",
    "Checkpoint": "qtab.callbacks.checkpoint",
    "EvaluateEvery": "qtab.callbacks.evaluate_every",
    "KeepBest": "qtab.callbacks.keep_best",
    "LivePlot": "qtab.callbacks.live_plot",
    "StopAtReturn": "qtab.callbacks.stop_at_return",
    "TensorBoardLogger": "qtab.callbacks.tensorboard_logger",
}

if TYPE_CHECKING:
    # The same table in the only form that editors and type checkers read. A test compares the two.
    from qtab.callbacks.checkpoint import Checkpoint as Checkpoint
    from qtab.callbacks.csv_logger import CSVLogger as CSVLogger
    from qtab.callbacks.evaluate_every import EvaluateEvery as EvaluateEvery
    from qtab.callbacks.keep_best import KeepBest as KeepBest
    from qtab.callbacks.live_plot import LivePlot as LivePlot
    from qtab.callbacks.stop_at_return import StopAtReturn as StopAtReturn
    from qtab.callbacks.tensorboard_logger import TensorBoardLogger as TensorBoardLogger
    from qtab.training.callbacks import BaseCallback as BaseCallback
else:
    # Hidden from type checkers, which accept any name from a module that has a __getattr__.
    __all__ = list(_MODULES)

    def __getattr__(name):
        if name not in _MODULES:
            from qtab._utils.shown import did_you_mean

            raise AttributeError(f"module 'qtab.callbacks' has no attribute {name!r}{did_you_mean(name, _MODULES)}")
        value = globals()[name] = getattr(_importlib.import_module(_MODULES[name]), name)
        return value


def __dir__() -> list[str]:
    return sorted([*_MODULES, *(name for name in globals() if name.startswith("__"))])
