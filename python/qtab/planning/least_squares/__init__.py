"""Least-squares policy iteration: a policy from a batch of transitions, with linear action values."""

from qtab.planning.least_squares.lspi import LeastSquaresPolicy, lspi
from qtab.planning.least_squares.lstdq import lstdq
from qtab.planning.least_squares.transitions import Transitions

__all__ = ["LeastSquaresPolicy", "Transitions", "lspi", "lstdq"]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]
