"""The input of the extension module: the complete, validated description of a run, with every union tagged by ``type``.

The extension parses it once into its own enums, which repeat the words of each union (``_core.ALGORITHMS`` and
similar); a test compares the two lists.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray
from typing_extensions import Required

if TYPE_CHECKING:
    from qtab._core import NativeEnv

# Discretizers

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


class BoxSpec(TypedDict):
    """The observations of weighted features, which multiply the rows."""

    dtype: FloatType
    low: Sequence[float]
    """What is scaled to 0."""
    high: Sequence[float]
    """What is scaled to 1."""


class FourierSpec(BoxSpec):
    """The Fourier basis."""

    type: Literal["fourier"]
    order: int
    coupled: bool
    scale_step_sizes: bool
    """Whether the learning rate of a feature is divided by the length of its frequency vector."""


class PolynomialSpec(BoxSpec):
    """Products of powers."""

    type: Literal["polynomial"]
    order: int
    coupled: bool


class RadialSpec(BoxSpec):
    """Gaussian radial basis functions."""

    type: Literal["radial"]
    centers: Sequence[int]
    """Along each component, evenly spaced from ``low`` to ``high``."""
    width: Sequence[float]
    """The standard deviation along each component, in distances between neighboring centers."""
    normalized: bool
    """Whether they are divided by their sum."""


class CoarseSpec(BoxSpec):
    """Coarse coding with receptive fields that are balls."""

    type: Literal["coarse"]
    centers: Sequence[int]
    radius: Sequence[float]
    """Along each component, in distances between neighboring centers."""


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


WeightedSpec: TypeAlias = FourierSpec | PolynomialSpec | RadialSpec | CoarseSpec
DiscretizerSpec: TypeAlias = RoundSpec | BinsSpec | TilesSpec | WeightedSpec | IdentitySpec | ProductSpec


# Environments


class NativeEnvSpec(TypedDict):
    """An environment that Rust steps."""

    type: Literal["native"]
    env: "NativeEnv"


class PythonEnvSpec(TypedDict):
    """An environment stepped in Python."""

    type: Literal["python"]
    env: Any
    first_action: int
    """The environment's number of the first action, if its space is Discrete."""
    actions: Sequence[Any]
    """The actions themselves, as arguments of ``step``; empty for a Discrete space."""
    action_mask: "MaskSourceSpec"


class ConventionalMaskSource(TypedDict):
    """No masks, or Gymnasium's ``info["action_mask"]``."""

    type: Literal["none", "info"]


class FunctionMaskSource(TypedDict):
    """Masks from a function."""

    type: Literal["function"]
    function: Callable[[Any], Any]
    """Maps an observation to its mask."""


MaskSourceSpec: TypeAlias = ConventionalMaskSource | FunctionMaskSource
EnvironmentSpec: TypeAlias = NativeEnvSpec | PythonEnvSpec

# The agent


class UnknownMasksSpec(TypedDict):
    """Every state has all actions (none), or the environment provides the masks (observed)."""

    type: Literal["none", "observed"]


class KnownMasksSpec(TypedDict):
    """Masks that are known before the first episode."""

    type: Literal["known"]
    available: NDArray[np.bool_]
    """(rows, actions)"""


ActionMasksSpec: TypeAlias = UnknownMasksSpec | KnownMasksSpec


class RunSpec(TypedDict):
    """A run without its seed."""

    env: EnvironmentSpec
    discretizer: DiscretizerSpec
    num_actions: int
    max_episode_steps: int
    action_masks: ActionMasksSpec
    settings: Mapping[str, Any]
    """The settings of the config, from which the extension reads those of the algorithm, exploration and schedules."""


# Prediction


class MethodSpec(TypedDict, total=False):
    """A prediction method with its options."""

    type: Required[str]
    n_steps: int
    trace_decay: float
    first_visit: bool
    weighted: bool
    second_learning_rate: float
    epsilon: float
    recursive: bool


class ObservationPolicySpec(TypedDict, total=False):
    """A policy that chooses by the observation."""

    type: Required[Literal["table", "greedy", "function"]]
    probabilities: NDArray[np.float64]
    """The probabilities of a table, (cells, actions), or (1, actions) for the same everywhere."""
    discretizer: DiscretizerSpec
    """The discretizer of a greedy policy."""
    tables: NDArray[np.float64]
    """The action values of a greedy policy, (tables, rows, actions); the tables are added."""
    function: Callable[[Any], Any]
    """Maps an observation to the number of an action, or to probabilities."""
    read: Callable[[Any, Any], Sequence[float]]
    """Converts any other return value of the function, with the observation, to probabilities, or raises an error."""
    first_action: int
    """The number of the first action."""


class ObservationPoliciesSpec(TypedDict):
    """Policies that choose by the observation."""

    target: ObservationPolicySpec | None
    """The policy that is evaluated; None for the one that acts."""
    behavior: ObservationPolicySpec


class PredictionSpec(TypedDict):
    """A prediction: the quantity to estimate and the method, besides the run that defines the task."""

    method: MethodSpec
    target: NDArray[np.float64] | None
    """The policy that is evaluated, (states, actions); None with ``policies``."""
    behavior: NDArray[np.float64] | None
    """The policy that chooses the actions, (states, actions); None with ``policies``."""
    policies: ObservationPoliciesSpec | None
    """Policies that read the observations of a Box."""
    rows: NDArray[np.uint32] | None
    """The active rows of each state, (states, n_active); None for vectors, or if they are those of the discretizer."""
    vectors: NDArray[np.float64] | None
    """The feature vector of each state, (states, n_weights); None for rows, or if the discretizer gives them."""
    initial_weights: NDArray[np.float64]
    """The initial weights, (n_weights,)."""


# Results


class Results(TypedDict):
    """The arrays for the results of many runs, with one row per run."""

    returns: NDArray[np.float64]
    """The return of each episode, (runs, episodes)."""
    lengths: NDArray[np.int64]
    """The length of each episode, (runs, episodes)."""
    terminated: NDArray[np.bool_]
    """Whether each episode ended in a terminal state, (runs, episodes)."""
    tables: NDArray[np.float64]
    """The final tables, (runs, values), or (runs, 0) if tables are not kept."""
    finished: NDArray[np.bool_]
    """Whether each run is finished, (runs,)."""
    masks: NDArray[np.bool_]
    """The last action masks of runs whose environments give them at each step, (runs, values) or (runs, 0)."""


Solution: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]
"""State values, action values and the policy."""
PolicyChanges: TypeAlias = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]
"""Changes of the policy: the number of remaining steps from which on the action is best, the state, the action."""
