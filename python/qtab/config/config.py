"""The settings of a run: names, types, defaults and explanations, also used for help texts and ``--help``.

Options, the settings that apply only to certain choices, are None here; their defaults are in options.py.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import html
from qtab._utils.comparable import comparable
from qtab._utils.fields import with_fields
from qtab.config.choices import (
    Algorithm,
    Backend,
    BitGenerator,
    DiscretizerName,
    EpsilonSchedule,
    Exploration,
    LearningRateSchedule,
    ModelKind,
    OnTruncation,
    TargetPolicy,
    TerminalUpdate,
    Ties,
    Traces,
)
from qtab.config.functions import Mask
from qtab.config.implied import with_followers, with_implied
from qtab.config.origin import WithOrigin, copied
from qtab.config.unknown import check_names
from qtab.config.validation import validated

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from qtab.config.settings import ConfigSettings, Settings


@with_fields
@dataclass(frozen=True, eq=False)
class Config(WithOrigin):
    """The settings of a run. With the same config, a run can be repeated exactly.

    A setting that is None was not given. The config of a run holds the value that was used instead, or None if the
    setting does not apply, such as the trace decay of an algorithm without traces. Giving such a setting is an error.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a value that is out of range, or that does not apply to the other settings.
    """

    # The environment

    env: str = "MountainCar-v0"
    """The environment's id in Gymnasium."""
    env_kwargs: Mapping[str, Any] = field(default_factory=dict)
    """Keyword arguments for the environment's constructor."""
    max_episode_steps: int | None = None
    """The time limit of an episode, in steps. None uses the environment's own limit, or 10,000 if it has none."""
    time_aware: bool = False
    """Whether the number of steps taken in the episode is part of the state, as in Gymnasium's TimeAwareObservation:
    the table has cells for each step before the time limit, and can learn the policy that is optimal under it. Only for
    discretizers with cells."""
    backend: Backend = "auto"
    """Where to step it: in Rust (rust), in Rust compiled by Numba (numba), in Python (gymnasium, python), or auto."""

    # The run

    episodes: int = 5000
    """The number of episodes to train."""
    seed: int | None = None
    """The seed of the environment and of the agent. None draws a seed, which the run's config records."""
    bit_generator: BitGenerator = "PCG64"
    """The agent's random generator: PCG64 as in np.random.default_rng, or MT19937 as in np.random.seed."""
    preset: str | None = None
    """A named set of values to start from. None uses the environment's first preset, if it has any."""

    # Learning

    algorithm: Algorithm = "q_learning"
    """The learning algorithm."""
    learning_rate: float = 0.2
    """α: the fraction of the error that an update corrects, in [0, 1]. With tile coding it is divided among the
    tilings, and may be up to 2. For preferences any step size that is not negative. For weighted features
    (fourier, polynomial, radial, coarse) it is not divided; the default, whatever the preset, is 0.001, or 0.1 with
    normalized=True."""
    discount: float = 0.9
    """γ: the discount factor, in [0, 1]. It is 1 if the average reward is learned, and 0 for the gradient bandit."""
    learning_rate_schedule: LearningRateSchedule = "constant"
    """The schedule of the learning rate: constant, linear or exponential over the episodes, or learning_rate / n at the
    n-th visit of a state and action (visits). A learning rate given alone is constant; with min_learning_rate or
    learning_rate_warm_up it falls linearly. Monte Carlo methods default to visits with a learning rate of 1: averages.
    Off-policy Monte Carlo, which needs visits, weights them."""
    min_learning_rate: float | None = None
    """The lowest learning rate of a schedule, in [0, learning_rate]."""
    learning_rate_decay: float | None = None
    """The factor by which an exponential schedule multiplies the learning rate after each episode, in [0, 1]."""
    learning_rate_warm_up: int | None = None
    """The number of episodes before the learning rate begins to fall."""
    trace_decay: float | None = None
    """λ: the decay of the eligibility traces, in [0, 1]."""
    traces: Traces | None = None
    """The effect of a visit on the trace of a state and action: accumulating adds 1 to it, replacing sets it to 1,
    clearing also sets the traces of the state's other actions to 0. With weighted features, such as those of fourier,
    accumulating adds their values and is the only choice."""
    trace_cutoff: float | None = None
    """Traces at or below this value are dropped, in [0, 1]. With 0, only traces that underflow to 0 are dropped."""
    n_steps: int | None = None
    """n: the number of rewards in a target."""
    sigma: float | None = None
    """σ: the degree of sampling of Q(σ), from 0 (tree backup: expected values) to 1 (sampled actions)."""
    target_policy: TargetPolicy | None = None
    """The policy whose values are learned: the greedy one (greedy), or the one that acts (behavior)."""
    planning_steps: int | None = None
    """The number of updates from the model after each step."""
    time_weight: float | None = None
    """κ: Dyna-Q+ plans with a bonus of κ √τ on the reward of an action not tried for τ steps."""
    model: ModelKind | None = None
    """The model of Dyna-Q: the last outcome of each state and action (deterministic), or a sample of all its outcomes
    so far (stochastic)."""
    priority_threshold: float | None = None
    """θ: prioritized sweeping plans only updates that would change a value by more than this, before α."""
    reward_learning_rate: float | None = None
    """β: the step size of the average reward, in [0, 1]."""
    baseline: bool | None = None
    """Whether the gradient bandit algorithm compares rewards with their average in the state, or with 0."""
    value_learning_rate: float | None = None
    """α of the state values that are learned besides a policy: the baseline of REINFORCE, the critic of actor-critic.
    The default is 0.1, or 0.005 with weighted features that are not normalized."""
    initial_q: float | tuple[float, float] | NDArray[np.float64] = (-1.0, 1.0)
    """The initial Q table, or preferences: drawn uniformly from a range (low, high), one number everywhere, or an array
    to continue from. In an array, -inf marks an action that a state does not have; it is never chosen. For weighted
    features these are weights, not values, by default 0: the first one of fourier and polynomial is added to all
    values."""
    terminal_update: TerminalUpdate = "target"
    """The update at a terminal state: move the value towards the reward (target, as in the textbook), or set it to the
    reward (assign, as in the well-known article)."""
    on_truncation: OnTruncation = "bootstrap"
    """The update at the time limit: bootstrap from the next state (correct), or terminate, as if the next state were
    terminal (a common mistake). With time_aware, where the limit is part of the task, terminate is correct, and the
    default. It is the only choice for REINFORCE and the gradient bandit algorithm, which never bootstrap."""

    # Exploration

    exploration: Exploration = "epsilon_greedy"
    """The policy: a random action with probability ε (epsilon_greedy), the softmax of the values (softmax), or the
    largest upper confidence bound (ucb). Algorithms that learn preferences need softmax, which is their default."""
    epsilon: float | None = None
    """ε: the probability of a random action in the first episode, in [0, 1]."""
    epsilon_schedule: EpsilonSchedule | None = None
    """The schedule of ε over the episodes. An ε given alone is constant; with min_epsilon or epsilon_warm_up it falls
    linearly. The default ε falls linearly, as in the article."""
    min_epsilon: float | None = None
    """The lowest ε, in [0, epsilon]. A linear schedule reaches it at the end of the run."""
    epsilon_decay: float | None = None
    """The factor by which an exponential schedule multiplies ε after each episode, in [0, 1]."""
    epsilon_warm_up: int | None = None
    """The number of episodes before ε begins to fall."""
    ties: Ties | None = None
    """The choice among several greedy actions: the first one, as in np.argmax, or a random one."""
    temperature: float | None = None
    """τ: softmax chooses an action with probability proportional to exp(Q / τ); above 0."""
    confidence: float | None = None
    """c: ucb chooses the action with the largest Q + c √(ln t / N) after N of t choices in a state; not negative."""

    count_bonus: float = 0.0
    """The exploration bonus: the agent learns from the reward + count_bonus / √n at the n-th visit of a state and
    action. 0 is no bonus; it is not part of the returns."""
    action_mask: Mask = False
    """The available actions of each observation: by the environment's masks (True), from its method action_masks() or
    else info["action_mask"]; by a function from an observation to (actions,) booleans or 0 and 1; or all (False).
    Masked actions are never chosen, and their values never used."""

    # The discretizer

    discretizer: DiscretizerName | Callable[[Any], Any] | Mapping[str, Any] = "round"
    """How observations index the Q table: rounded to a grid (round), by bins of equal width (bins) or between given
    edges (edges), by tile coding (tiles), directly (identity), the default for discrete spaces, or by weighted
    features, which multiply all rows: a Fourier basis (fourier), polynomials (polynomial), radial basis functions
    (radial) or coarse coding (coarse). Or a function from an observation to its indices within shape; or a mapping from
    the keys of a Dict or Tuple space to the name or the options of a discretizer each:
    {"position": {"discretizer": "bins", "bins": 20}}."""
    shape: tuple[int, ...] | None = None
    """The shape of the table without its actions, for a function that returns indices within it."""
    max_rows: int | None = None
    """The number of rows of a table that assigns rows to observations as they are seen, for spaces with more cells than
    a table can have. One additional row is for all observations without a row."""
    scale: tuple[float, ...] = ()
    """Cells per unit of each component of the observation: (10, 100) rounds to multiples of 0.1 and 0.01."""
    tilings: int | None = None
    """The number of overlapping tilings, at most 32."""
    tiles: tuple[int, ...] | None = None
    """The number of tiles along each component of the observation, or one number for all."""
    hashed_rows: int | None = None
    """The number of rows that all tiles share by hashing, for tilings too large for memory. None gives each tile its
    own row."""
    bins: tuple[int, ...] | None = None
    """The number of bins along each component of the observation, or one number for all."""
    edges: tuple[tuple[float, ...], ...] | None = None
    """The inner edges between the bins of each component of the observation, ascending, as np.digitize takes them."""
    order: int | None = None
    """The order n of a basis: the frequencies or exponents of its features are integers from 0 to n."""
    coupled: bool | None = None
    """Whether a basis has all (n + 1)^d combinations of the frequencies or exponents of d components, or only the d n +
    1 features of single components."""
    scale_step_sizes: bool | None = None
    """Whether the learning rate of a Fourier feature is divided by the length of its frequency vector, if not 0."""
    centers: tuple[int, ...] | None = None
    """The number of centers of features along each component of the observation, or one number for all. They are
    evenly spaced from the lower to the upper limit."""
    width: tuple[float, ...] | None = None
    """σ, the width of radial basis functions along each component of the observation, or one number for all, in
    distances between neighboring centers."""
    normalized: bool | None = None
    """Whether radial basis functions are divided by their sum, so that they sum to 1."""
    radius: tuple[float, ...] | None = None
    """The radius of the receptive fields of coarse coding along each component of the observation, or one number for
    all, in distances between neighboring centers."""
    low: tuple[float, ...] | None = None
    """The lower limits of bins, tilings or weighted features, one for each component of the observation. None uses
    those of the observation space. Values outside the limits fall into the outermost bin or tile; for weighted features
    they are clipped to them."""
    high: tuple[float, ...] | None = None
    """The upper limits of bins, tilings or weighted features, like low."""
    actions: int | tuple[float | tuple[float, ...], ...] | None = None
    """The actions to choose from if the action space is a Box: the number of evenly spaced values along each component,
    from low to high, or the actions themselves."""

    if TYPE_CHECKING:
        # For type checkers, which would otherwise expect the stored types, not the types that may be given.
        def __init__(self, env: str = ..., **settings: Unpack[Settings]) -> None: ...

    def __post_init__(self) -> None:
        """Checks the values and converts NumPy's numbers to Python's."""
        vars(self).update(validated(vars(self), DEFAULTS))

    def __eq__(self, other: object) -> bool:
        """Whether all settings are equal; arrays are compared byte by byte."""
        if not isinstance(other, Config):
            return NotImplemented
        return all(comparable(value) == comparable(getattr(other, name)) for name, value in vars(self).items())

    def __hash__(self) -> int:
        """The hash of the settings, without those whose values may be unhashable."""
        unhashable = ("env_kwargs", "initial_q", "discretizer")
        return hash(tuple(value for name, value in vars(self).items() if name not in unhashable))

    def _repr_html_(self) -> str:
        """The settings that apply as a table, for notebooks."""
        given = {name: value for name, value in vars(self).items() if value is not None}
        if not self.env_kwargs:
            del given["env_kwargs"]
        shown = {
            name: f"array of shape {value.shape}" if isinstance(value, np.ndarray) else repr(value)
            for name, value in given.items()
        }
        return html.summary(f"Config of {self.env}", shown)

    def replace(self, **changes: "Unpack[ConfigSettings]") -> "Config":
        """Returns a copy with some settings changed.

        With another ``env``, the config of a run loses its preset, the settings that training derived from the old
        environment, and the keyword arguments from the old environment's registration. With a discretizer whose
        features have another scale, or another ``normalized``, learning rates, their schedule and ``initial_q`` have
        their defaults unless they are changed, too.

        Raises:
            TypeError: for an unknown setting, or a value of the wrong type.
            ValueError: for a value that is out of range, or that does not apply to the other settings.
        """
        check_names(changes, DEFAULTS)
        given, origin = with_followers(self, changes, DEFAULTS)
        return copied(replace(self, **given), origin)


DEFAULTS: Mapping[str, Any] = {
    field.name: field.default_factory() if callable(field.default_factory) else field.default
    for field in fields(Config)
}
"""The default of each field."""


setattr(Config, "__init__", with_implied(Config.__init__, DEFAULTS))  # noqa: B010 - type checkers refuse the assignment


def replace_checked(config: Config, **changes: Any) -> Config:
    """Returns a copy with some fields changed, without checks, for values that are known to be valid."""
    changed = copied(config, config.origin)
    vars(changed).update(changes)
    return changed
