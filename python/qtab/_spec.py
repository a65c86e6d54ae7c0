"""What the extension module takes: the description of a run, complete and checked, every union tagged by ``type``.

The extension parses it once into its own enums. The words of each union stand there a second time (``_core.ALGORITHMS``
and its like); a test holds the two lists together.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray
from typing_extensions import Required

from qtab._discretizer_spec import DiscretizerSpec as DiscretizerSpec

if TYPE_CHECKING:
    from qtab._core import NativeEnv

# Environments


class NativeEnvSpec(TypedDict):
    """An environment that Rust steps."""

    type: Literal["native"]
    env: "NativeEnv"


class PythonEnvSpec(TypedDict):
    """An environment that is stepped in Python."""

    type: Literal["python"]
    env: Any
    first_action: int
    """The environment's number of the first action, where its space is Discrete."""
    actions: Sequence[Any]
    """The actions themselves, as ``step`` takes them; empty for a Discrete space."""
    action_mask: "MaskSourceSpec"


class ConventionalMaskSource(TypedDict):
    """No masks, or Gymnasium's ``info["action_mask"]``."""

    type: Literal["none", "info"]


class FunctionMaskSource(TypedDict):
    """Masks by a function."""

    type: Literal["function"]
    function: Callable[[Any], Any]
    """From an observation to its mask."""


MaskSourceSpec: TypeAlias = ConventionalMaskSource | FunctionMaskSource
EnvironmentSpec: TypeAlias = NativeEnvSpec | PythonEnvSpec

# The agent


class UnknownMasksSpec(TypedDict):
    """Every state has all actions (none), or the environment gives the masks (observed)."""

    type: Literal["none", "observed"]


class KnownMasksSpec(TypedDict):
    """Masks that are known before the first episode."""

    type: Literal["known"]
    available: NDArray[np.bool_]
    """(rows, actions)"""


ActionMasksSpec: TypeAlias = UnknownMasksSpec | KnownMasksSpec


class RunSpec(TypedDict):
    """A run, but for its seed."""

    env: EnvironmentSpec
    discretizer: DiscretizerSpec
    num_actions: int
    max_episode_steps: int
    action_masks: ActionMasksSpec
    settings: Mapping[str, Any]
    """Those of the config, of which the extension reads what the algorithm, the exploration and the schedules have."""


# Prediction


class MethodSpec(TypedDict, total=False):
    """A prediction method with its options."""

    type: Required[str]
    n_steps: int
    trace_decay: float
    first_visit: bool
    weighted: bool


class ObservationPolicySpec(TypedDict, total=False):
    """A policy that chooses by the observation."""

    type: Required[Literal["table", "greedy", "function"]]
    probabilities: NDArray[np.float64]
    """(cells, actions), or (1, actions) for the same everywhere, of a table."""
    discretizer: DiscretizerSpec
    """Of a greedy policy."""
    tables: NDArray[np.float64]
    """(tables, rows, actions): the action values of a greedy policy, which are added."""
    function: Callable[[Any], Any]
    """From an observation to the number of an action or to probabilities."""
    read: Callable[[Any, Any], Sequence[float]]
    """From any other answer of the function, and the observation, to probabilities; or it raises an error."""
    first_action: int
    """The number of the first action."""


class ObservationPoliciesSpec(TypedDict):
    """Policies that choose by the observation."""

    target: ObservationPolicySpec | None
    """The policy that is evaluated; None for the one that acts."""
    behavior: ObservationPolicySpec


class PredictionSpec(TypedDict):
    """What is estimated, beside the run whose task it is."""

    method: MethodSpec
    target: NDArray[np.float64] | None
    """(states, actions): the policy that is evaluated; None with ``policies``."""
    behavior: NDArray[np.float64] | None
    """(states, actions): the policy that chooses the actions; None with ``policies``."""
    policies: ObservationPoliciesSpec | None
    """Policies that read the observations of a Box."""
    rows: NDArray[np.uint32] | None
    """(states, n_active); None where the features of an observation are the active rows of the discretizer."""
    initial_weights: NDArray[np.float64]
    """(n_weights,)"""


# Results


class Results(TypedDict):
    """The arrays into which many runs write their results: a row for each run."""

    returns: NDArray[np.float64]
    """(runs, episodes)"""
    lengths: NDArray[np.int64]
    """(runs, episodes)"""
    terminated: NDArray[np.bool_]
    """(runs, episodes)"""
    tables: NDArray[np.float64]
    """(runs, values), or (runs, 0) where tables are not kept."""
    finished: NDArray[np.bool_]
    """(runs,)"""
    masks: NDArray[np.bool_]
    """(runs, values) or (runs, 0): the action masks of runs that are stepped in Python, beside the tables."""


Solution: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]
"""State values, action values and the policy."""
PolicyChanges: TypeAlias = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]
"""From how many remaining steps on, in which state, which action is best."""
