"""Tabular and linear reinforcement learning in Rust on Gymnasium environments, bit for bit as in Gymnasium and NumPy.

    import qtab

    run = qtab.train("MountainCar-v0", seed=0)
    run.mean_returns(100)

Importing qtab registers the environments ``qtab/…`` with Gymnasium. The public names load when first used.
"""

import importlib as _importlib
from typing import TYPE_CHECKING

from qtab.envs import register as _register
from qtab.results import page as _page

_MODULES = {
    "Animation": "qtab.rendering.animate",
    "Axis": "qtab.results.axes",
    "Config": "qtab.config",
    "Confirmation": "qtab.sweeps.confirm",
    "Diagnosis": "qtab.diagnosis.diagnosis",
    "Evaluation": "qtab.training.evaluate",
    "Explanation": "qtab.explanation.explanation",
    "FunctionalEnv": "qtab.envs.functional",
    "Gap": "qtab.planning.gap",
    "NativeEnv": "qtab.envs.external.native_env",
    "Optimum": "qtab.planning.optimum",
    "Playback": "qtab.rendering.play",
    "PolicyValues": "qtab.planning.policy_values",
    "Progress": "qtab.training.progress",
    "Recording": "qtab.results.recording",
    "Run": "qtab.results.run",
    "Runs": "qtab.results.runs",
    "RunsProgress": "qtab.training.runs_progress",
    "RustVectorEnv": "qtab.envs.vector",
    "Snapshots": "qtab.results.recording",
    "StoreError": "qtab.sweeps.connection",
    "Sweep": "qtab.sweeps.results",
    "SweepProgress": "qtab.sweeps.training",
    "TabularEnv": "qtab.envs.tabular",
    "TabulatedEnv": "qtab.envs.tabulation.tabulated_env",
    "ValueEstimates": "qtab.prediction.estimates",
    "Verification": "qtab.training.verify",
    "animate": "qtab.rendering.animate",
    "book": "qtab.book",
    "callbacks": "qtab.callbacks",
    "designs": "qtab.sweeps.designs",
    "diagnose": "qtab.diagnosis.diagnose",
    "estimate_values": "qtab.prediction.estimate",
    "evaluate": "qtab.training.evaluate",
    "exercises": "qtab.exercises",
    "explain": "qtab.explanation.explain",
    "get_include": "qtab.envs.external.include",
    "load": "qtab.results.files.loading",
    "load_runs": "qtab.results.files.loading",
    "load_sweep": "qtab.sweeps.sweep",
    "optimum": "qtab.planning.solve",
    "planning": "qtab.planning",
    "play": "qtab.rendering.play",
    "playground": "qtab.playground",
    "plot": "qtab.plots.run",
    "plots": "qtab.plots",
    "policy_values": "qtab.planning.policy_values",
    "prediction": "qtab.prediction",
    "presets": "qtab.config.presets",
    "resume": "qtab.training.resume",
    "sb3": "qtab.sb3",
    "stats": "qtab.stats",
    "sweep": "qtab.sweeps.sweep",
    "tabulate": "qtab.envs.tabulation.tabulate",
    "train": "qtab.training.train",
    "train_many": "qtab.training.train_many",
    "verify": "qtab.training.verify",
}
"""The module that defines each public name, or, for modules, the module itself."""

if TYPE_CHECKING:
    # The same table, in the only form that editors and type checkers read. A test compares the two.
    from qtab import book as book
    from qtab import callbacks as callbacks
    from qtab import exercises as exercises
    from qtab import planning as planning
    from qtab import playground as playground
    from qtab import plots as plots
    from qtab import prediction as prediction
    from qtab import sb3 as sb3
    from qtab import stats as stats
    from qtab.config import Config as Config
    from qtab.config.presets import presets as presets
    from qtab.diagnosis.diagnose import diagnose as diagnose
    from qtab.diagnosis.diagnosis import Diagnosis as Diagnosis
    from qtab.envs.external.include import get_include as get_include
    from qtab.envs.external.native_env import NativeEnv as NativeEnv
    from qtab.envs.functional import FunctionalEnv as FunctionalEnv
    from qtab.envs.tabular import TabularEnv as TabularEnv
    from qtab.envs.tabulation.tabulate import tabulate as tabulate
    from qtab.envs.tabulation.tabulated_env import TabulatedEnv as TabulatedEnv
    from qtab.envs.vector import RustVectorEnv as RustVectorEnv
    from qtab.explanation.explain import explain as explain
    from qtab.explanation.explanation import Explanation as Explanation
    from qtab.planning.gap import Gap as Gap
    from qtab.planning.optimum import Optimum as Optimum
    from qtab.planning.policy_values import PolicyValues as PolicyValues
    from qtab.planning.policy_values import policy_values as policy_values
    from qtab.planning.solve import optimum as optimum
    from qtab.plots.run import plot as plot
    from qtab.prediction.estimate import estimate_values as estimate_values
    from qtab.prediction.estimates import ValueEstimates as ValueEstimates
    from qtab.rendering.animate import Animation as Animation
    from qtab.rendering.animate import animate as animate
    from qtab.rendering.play import Playback as Playback
    from qtab.rendering.play import play as play
    from qtab.results.axes import Axis as Axis
    from qtab.results.files.loading import load as load
    from qtab.results.files.loading import load_runs as load_runs
    from qtab.results.recording import Recording as Recording
    from qtab.results.recording import Snapshots as Snapshots
    from qtab.results.run import Run as Run
    from qtab.results.runs import Runs as Runs
    from qtab.sweeps import designs as designs
    from qtab.sweeps.confirm import Confirmation as Confirmation
    from qtab.sweeps.connection import StoreError as StoreError
    from qtab.sweeps.results import Sweep as Sweep
    from qtab.sweeps.sweep import load_sweep as load_sweep
    from qtab.sweeps.sweep import sweep as sweep
    from qtab.sweeps.training import SweepProgress as SweepProgress
    from qtab.training.evaluate import Evaluation as Evaluation
    from qtab.training.evaluate import evaluate as evaluate
    from qtab.training.progress import Progress as Progress
    from qtab.training.resume import resume as resume
    from qtab.training.runs_progress import RunsProgress as RunsProgress
    from qtab.training.train import train as train
    from qtab.training.train_many import train_many as train_many
    from qtab.training.verify import Verification as Verification
    from qtab.training.verify import verify as verify

    __version__: str
else:
    # Hidden from type checkers, which accept any name from a module with a __getattr__.
    __all__ = list(_MODULES)

    def __getattr__(name):
        if name == "__version__":
            from qtab._utils.versions import distribution_version

            return distribution_version()
        if name not in _MODULES:
            from qtab._utils.shown import did_you_mean

            raise AttributeError(f"module 'qtab' has no attribute {name!r}{did_you_mean(name, _MODULES)}")
        module = _importlib.import_module(_MODULES[name])
        value = globals()[name] = getattr(module, name, module)
        return value


def __dir__() -> list[str]:
    return sorted([*_MODULES, "__version__", *(name for name in globals() if name.startswith("__"))])


_register()
_page.WRITER = "qtab.rendering.run_page"
