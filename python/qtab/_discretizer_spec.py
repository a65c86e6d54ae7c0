"""What the extension module takes as the description of a discretizer; see :mod:`qtab._spec`."""

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias, TypedDict

FloatType: TypeAlias = Literal["float32", "float64"]


class RoundSpec(TypedDict):
    """A grid: each component rounded to the nearest multiple of 1 / ``scale``."""

    type: Literal["round"]
    dtype: FloatType
    """Of the observations, and of the arithmetic."""
    low: Sequence[float]
    """The bounds of the observation space."""
    high: Sequence[float]
    scale: Sequence[float]
    """Cells per unit of each component."""


class BinsSpec(TypedDict):
    """A grid of bins between edges, as ``numpy.digitize`` numbers them; ``bins`` and ``edges`` of the config."""

    type: Literal["bins"]
    dtype: FloatType
    edges: Sequence[Sequence[float]]
    """For each component the inner edges, ascending."""


class TilesSpec(TypedDict):
    """Tile coding."""

    type: Literal["tiles"]
    dtype: FloatType
    low: Sequence[float]
    """What the tilings span."""
    high: Sequence[float]
    tiles: Sequence[int]
    """Along each component."""
    tilings: int
    hashed_rows: int | None
    """The rows that all tilings share; None gives each tile its own."""


class IdentitySpec(TypedDict):
    """Integers, each combination a row in C order."""

    type: Literal["identity"]
    first: Sequence[int]
    """The first integer of each component."""
    counts: Sequence[int]
    """How many integers each component takes."""
    scalar: bool
    """Whether an observation is one integer (a Discrete space), not a sequence of them."""


class FactorSpec(TypedDict):
    """Some components of an observation, and the rows of the table that theirs stand for."""

    components: Sequence[int]
    """Their indices in the observation: one, except for tiles."""
    stride: int
    """By how much the row of the table increases with theirs."""
    discretizer: Any
    """Their DiscretizerSpec: identity, round, bins or tiles."""


class ProductSpec(TypedDict):
    """Components that are discretized differently: each combination of their rows is a row of the table."""

    type: Literal["product"]
    dimensions: int
    """How many components an observation has."""
    factors: Sequence[FactorSpec]


DiscretizerSpec: TypeAlias = RoundSpec | BinsSpec | TilesSpec | IdentitySpec | ProductSpec
