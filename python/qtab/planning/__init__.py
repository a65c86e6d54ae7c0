"""The best policy of an environment, exact or the best known, and how far a run falls short of it."""

from qtab.planning.gap import Gap
from qtab.planning.optimum import Optimum
from qtab.planning.policy_values import PolicyValues, policy_values
from qtab.planning.solve import optimum

__all__ = ["Gap", "Optimum", "PolicyValues", "optimum", "policy_values"]
