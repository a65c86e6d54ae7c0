"""Weighted features in plain NumPy: a number for each row of the table (Sutton & Barto, 2nd ed., section 9.5)."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import reduce
from itertools import product
from operator import add, mul
from typing import TypeAlias

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike

from qtab._utils.checks import required
from qtab.config import Config


class WeightedRows(list[int]):
    """All rows of the table, in their order, with the value of the feature of each row."""

    def __init__(self, x: list[float]) -> None:
        super().__init__(range(len(x)))
        self.x = x


class WeightedFeatures(ABC):
    """Features of states s in [0, 1]^d, to which observations between the limits are scaled."""

    n_active = 1  # the features do not share the learning rate
    divisors: list[float] | None = None
    """The number that divides the learning rate of each feature; None if all have the same."""

    def __init__(self, space: gym.spaces.Box, config: Config) -> None:
        self.dtype = space.dtype
        self.low, self.high = np.array(config.low), np.array(config.high)
        self.prepare(config, len(self.low))
        self.shape: tuple[int, ...] = (len(self.x([0.0] * len(self.low))),)

    @abstractmethod
    def prepare(self, config: Config, d: int) -> None:
        """Reads the options of the features of ``d`` components."""

    @abstractmethod
    def x(self, s: list[float]) -> list[float]:
        """Returns the features of a state."""

    def rows(self, observation: ArrayLike) -> WeightedRows:
        """Returns every row, with its feature."""
        numbers = np.asarray(observation, dtype=self.dtype).astype(np.float64)
        s = (np.clip(numbers, self.low, self.high) - self.low) / (self.high - self.low)
        return WeightedRows(self.x(s.tolist()))


class FourierBasis(WeightedFeatures):
    """The features cos(π c·s) (Konidaris, Osentoski & Thomas, 2011; section 9.5.2).

    The cosine of a sum is the real part of a product of the powers of e^(iπs_j), which the addition theorem gives.
    """

    def prepare(self, config: Config, d: int) -> None:
        """Lists the frequency vectors."""
        self.count = required("order", config.order) + 1
        self.c = multi_indices(self.count, d, coupled=required("coupled", config.coupled))
        lengths = [math.sqrt(sum(k * k for k in c)) or 1.0 for c in self.c]
        self.divisors = lengths if config.scale_step_sizes else None

    def x(self, s: list[float]) -> list[float]:
        """Returns the cosine for each frequency vector."""
        z = [complex_powers(math.cos(math.pi * s_j), math.sin(math.pi * s_j), self.count) for s_j in s]
        return [reduce(complex_product, [z[j][k] for j, k in enumerate(c)])[0] for c in self.c]


class PolynomialBasis(WeightedFeatures):
    """The products of the powers s_1^c_1 s_2^c_2 ... of the components (section 9.5.1)."""

    def prepare(self, config: Config, d: int) -> None:
        """Lists the exponents."""
        self.count = required("order", config.order) + 1
        self.c = multi_indices(self.count, d, coupled=required("coupled", config.coupled))

    def x(self, s: list[float]) -> list[float]:
        """Returns the product of powers for each vector of exponents."""
        powers = [[1.0] for _ in s]
        for of_component, s_j in zip(powers, s, strict=True):
            for _ in range(1, self.count):
                of_component.append(of_component[-1] * s_j)
        return [reduce(mul, [powers[j][k] for j, k in enumerate(c)]) for c in self.c]


class RadialBasis(WeightedFeatures):
    """Gaussians exp(-‖s - c‖² / 2σ²) around the centers c of a grid (section 9.5.5).

    Distances are counted in those between neighboring centers. A Gaussian of several components is the product of those
    of single ones, so that all of them sum to 1 if those of each component do.
    """

    def prepare(self, config: Config, d: int) -> None:  # noqa: ARG002
        """Reads the numbers of centers and the widths."""
        self.centers, self.width = required("centers", config.centers), required("width", config.width)
        self.normalized = required("normalized", config.normalized)

    def x(self, s: list[float]) -> list[float]:
        """Returns the Gaussian around each center."""
        factors = [
            [math.exp(-0.5 * (z * z)) for z in distances(s_j, count, sigma)]
            for s_j, count, sigma in zip(s, self.centers, self.width, strict=True)
        ]
        if self.normalized:
            factors = [[g / reduce(add, of_component) for g in of_component] for of_component in factors]
        return [reduce(mul, combined) for combined in product(*factors)]


class CoarseCoding(WeightedFeatures):
    """1 within a receptive field, a ball around a center of a grid, and 0 outside (section 9.5.3)."""

    def prepare(self, config: Config, d: int) -> None:  # noqa: ARG002
        """Reads the numbers of centers and the radii."""
        self.centers, self.radius = required("centers", config.centers), required("radius", config.radius)

    def x(self, s: list[float]) -> list[float]:
        """Returns whether the state is within the receptive field around each center."""
        squares = [
            [z * z for z in distances(s_j, count, r)]
            for s_j, count, r in zip(s, self.centers, self.radius, strict=True)
        ]
        return [float(reduce(add, combined) <= 1.0) for combined in product(*squares)]


WEIGHTED: Mapping[str, type[WeightedFeatures]] = {
    "fourier": FourierBasis,
    "polynomial": PolynomialBasis,
    "radial": RadialBasis,
    "coarse": CoarseCoding,
}
"""The weighted features by the name of the discretizer."""


def multi_indices(count: int, d: int, *, coupled: bool) -> list[tuple[int, ...]]:
    """Returns all vectors of ``d`` integers below ``count``, in C order; or those with at most one that is not 0."""
    if coupled:
        return list(np.ndindex(*[count] * d))
    return [(0,) * d] + [tuple(k * (i == j) for j in range(d)) for i in range(d) for k in range(1, count)]


def distances(s_j: float, count: int, extent: float) -> list[float]:
    """Returns the distances of a component in [0, 1] from ``count`` centers.

    Args:
        s_j: The component.
        count: The number of centers, the first at 0 and the last at 1.
        extent: The unit, in distances between neighboring centers.
    """
    return [(s_j * (count - 1) - k) / extent for k in range(count)]


Complex: TypeAlias = tuple[float, float]
"""The real and the imaginary part of a number. Python's ``complex`` may be multiplied with fewer roundings."""


def complex_product(a: Complex, b: Complex) -> Complex:
    """Returns the product of two complex numbers."""
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def complex_powers(re: float, im: float, count: int) -> list[Complex]:
    """Returns the powers z^0, ..., z^(count - 1) of a complex number, each the product of two with half its exponent.

    For odd exponents, the first factor has the larger half.
    """
    z = [(1.0, 0.0), (re, im)]
    for k in range(2, count):
        z.append(complex_product(z[k - k // 2], z[k // 2]))
    return z
