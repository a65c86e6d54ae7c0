"""The origin of a run: the description of its environment, its comparison with others, and its re-creation."""

from qtab.envs.origin.again import make_again, needs_object
from qtab.envs.origin.describe import describe
from qtab.envs.origin.description import EnvironmentDescription, WrapperDescription, differences

__all__ = [
    "EnvironmentDescription",
    "WrapperDescription",
    "describe",
    "differences",
    "make_again",
    "needs_object",
]
