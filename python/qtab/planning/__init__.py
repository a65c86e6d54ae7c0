"""The best policy of an environment; the values of policies; dynamic programming; least-squares policy iteration."""

from qtab.planning.expected_updates import ExpectedUpdates
from qtab.planning.gap import Gap
from qtab.planning.least_squares import LeastSquaresPolicy, Transitions, lspi, lstdq
from qtab.planning.optimum import Optimum
from qtab.planning.policy_values import PolicyValues, policy_values
from qtab.planning.solve import optimum
from qtab.planning.sweeps import Improvement, policy_evaluation, policy_iteration, value_iteration
from qtab.planning.tabular import StationaryPolicy

__all__ = [
    "ExpectedUpdates",
    "Gap",
    "Improvement",
    "LeastSquaresPolicy",
    "Optimum",
    "PolicyValues",
    "StationaryPolicy",
    "Transitions",
    "lspi",
    "lstdq",
    "optimum",
    "policy_evaluation",
    "policy_iteration",
    "policy_values",
    "value_iteration",
]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]
