"""The settings of a run: names, types, defaults and explanations, from which help texts and ``--help`` are made.

Options, the settings that apply only beside certain choices, have None here; their defaults are in options.py.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import wraps
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import html
from qtab._utils.fields import with_fields
from qtab.config.action_mask import Mask
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
from qtab.config.followers import with_followers
from qtab.config.options import PREFERENCES, fixed_settings
from qtab.config.origin import WithOrigin, copied
from qtab.config.rates import implied_schedules
from qtab.config.unknown import check_names
from qtab.config.validation import validated

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from qtab.config.settings import ConfigSettings, Settings


@with_fields
@dataclass(frozen=True, eq=False)
class Config(WithOrigin):
    """The settings of a run: with the same config, it can be repeated exactly.

    A setting that is None was not given. The config of a run holds the value that was used instead, and None where the
    setting does not apply, such as the trace decay of an algorithm without traces. Giving such a setting is an error.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a value that is out of range, or that does not apply beside the others.
    """

    # The environment

    env: str = "MountainCar-v0"
    """The environment's id in Gymnasium."""
    env_kwargs: Mapping[str, Any] = field(default_factory=dict)
    """Keyword arguments for the environment's constructor."""
    max_episode_steps: int | None = None
    """The time limit of an episode, in steps. None takes the environment's own, or 10,000 if it has none."""
    time_aware: bool = False
    """Whether the number of steps taken in the episode is part of the state, as in Gymnasium's TimeAwareObservation:
    the table has cells for each step before the time limit, and can learn the policy that is optimal under it. For
    discretizers with cells."""
    backend: Backend = "auto"
    """Where the environment is stepped: in Rust, in Python by Gymnasium, or (auto) in Rust where that is possible."""

    # The run

    episodes: int = 5000
    """The number of episodes to train."""
    seed: int | None = None
    """The seed of the environment and of the agent. None draws one, which the run's config records."""
    bit_generator: BitGenerator = "PCG64"
    """The agent's random generator: PCG64 as in np.random.default_rng, or MT19937 as in np.random.seed."""
    preset: str | None = None
    """A named set of values to start from. None takes the environment's first preset, if it has any."""

    # Learning

    algorithm: Algorithm = "q_learning"
    """The learning algorithm."""
    learning_rate: float = 0.2
    """α: the fraction of the error that an update corrects, in [0, 1]. With tile coding it is divided among the
    tilings, and may be up to 2. For preferences any step size that is not negative."""
    discount: float = 0.9
    """γ: the discount factor, in [0, 1]. It is 1 where the average reward is learned, and 0 for the gradient bandit."""
    learning_rate_schedule: LearningRateSchedule = "constant"
    """How the learning rate falls: linearly or exponentially over the episodes, or (visits) as learning_rate / n at the
    n-th visit of a state and action. A learning rate that is given alone is constant; with min_learning_rate or
    learning_rate_warm_up it falls linearly. The default of Monte Carlo methods is visits, with a learning rate of 1:
    averages. Off-policy Monte Carlo, which needs it, weights the visits."""
    min_learning_rate: float | None = None
    """The lowest learning rate of a schedule, in [0, learning_rate]."""
    learning_rate_decay: float | None = None
    """The factor by which an exponential schedule multiplies the learning rate after each episode, in [0, 1]."""
    learning_rate_warm_up: int | None = None
    """The number of episodes before the learning rate begins to fall."""
    trace_decay: float | None = None
    """λ: the decay of the eligibility traces, in [0, 1]."""
    traces: Traces | None = None
    """What a visit does to the trace of a state and action: accumulating adds 1 to it, replacing sets it to 1, clearing
    also sets those of the state's other actions to 0."""
    trace_cutoff: float | None = None
    """Traces at or below this are dropped, in [0, 1]. With 0, only those that underflow to 0 are."""
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
    """What Dyna-Q plans with: what last followed a state and action (deterministic), or a sample of all that followed
    it so far (stochastic)."""
    priority_threshold: float | None = None
    """θ: prioritized sweeping plans the updates that would change a value by more than this, before α."""
    reward_learning_rate: float | None = None
    """β: the step size of the average reward, in [0, 1]."""
    baseline: bool | None = None
    """Whether the gradient bandit algorithm compares rewards with their average in the state, or with 0."""
    value_learning_rate: float | None = None
    """α of the state values that are learned beside a policy: the baseline of REINFORCE, the critic of actor-critic."""
    initial_q: float | tuple[float, float] | NDArray[np.float64] = (-1.0, 1.0)
    """The initial Q table, or preferences: drawn uniformly from a range (low, high), one number everywhere, or an array
    to continue from. In an array, -inf marks an action that a state does not have and that is never chosen."""
    terminal_update: TerminalUpdate = "target"
    """The update at a terminal state: move the value towards the reward (target, as in the textbook), or set it to the
    reward (assign, as in the well-known article)."""
    on_truncation: OnTruncation = "bootstrap"
    """The update where the time limit ends an episode: bootstrap from the next state (correct), or terminate, as if the
    next state were terminal (a common mistake). With time_aware, where the limit is part of the task, nothing follows
    the last step: terminate is correct there, and the default. It is the only choice for REINFORCE and the gradient
    bandit algorithm, which never bootstrap."""

    # Exploration

    exploration: Exploration = "epsilon_greedy"
    """How the agent chooses actions: a random one at times (epsilon_greedy), by the softmax of the values, or by their
    upper confidence bounds (ucb). Algorithms that learn preferences need softmax, which is their default."""
    epsilon: float | None = None
    """ε: the probability of a random action in the first episode, in [0, 1]."""
    epsilon_schedule: EpsilonSchedule | None = None
    """How ε changes over the episodes. An ε that is given alone is constant; with min_epsilon or epsilon_warm_up it
    falls linearly. The default ε falls linearly, as in the article."""
    min_epsilon: float | None = None
    """The lowest ε, in [0, epsilon]. A linear schedule reaches it at the end of the run."""
    epsilon_decay: float | None = None
    """The factor by which an exponential schedule multiplies ε after each episode, in [0, 1]."""
    epsilon_warm_up: int | None = None
    """The number of episodes before ε begins to fall."""
    ties: Ties | None = None
    """Which of several greedy actions to take: the first, as np.argmax does, or a random one."""
    temperature: float | None = None
    """τ: softmax chooses an action with probability proportional to exp(Q / τ); above 0."""
    confidence: float | None = None
    """c: ucb chooses the action with the largest Q + c √(ln t / N) after N of t choices in a state; not negative."""

    count_bonus: float = 0.0
    """The bonus of exploration: the agent learns from the reward + count_bonus / √n at the n-th visit of a state and
    action. 0 is none; it is not part of the returns."""
    action_mask: Mask = False
    """Which actions each observation has: those of the environment's masks (True), by its method action_masks() or else
    in info["action_mask"]; those of a function, from an observation to (actions,) booleans or 0 and 1; or all (False).
    Actions that are masked are never chosen, and their values never used."""

    # The discretizer

    discretizer: DiscretizerName | Callable[[Any], Any] | Mapping[str, Any] = "round"
    """How observations index the Q table: rounded to a grid (round), by bins of equal width (bins) or between given
    edges (edges), by tile coding (tiles), or as they are (identity), which is the default for discrete spaces. Or a
    function from an observation to its indices within shape; or a mapping from the keys of a Dict or Tuple space to a
    discretizer each, as a name or with its options: {"position": {"discretizer": "bins", "bins": 20}}."""
    shape: tuple[int, ...] | None = None
    """The shape of the table without its actions, in which the indices lie that a function returns."""
    max_rows: int | None = None
    """The number of rows of a table whose rows are assigned as observations are seen, for spaces of more cells than a
    table can have. One row more stands for what was not seen."""
    scale: tuple[float, ...] = ()
    """Cells per unit of each component of the observation: (10, 100) rounds to multiples of 0.1 and 0.01."""
    tilings: int | None = None
    """The number of overlapping tilings, at most 32."""
    tiles: tuple[int, ...] | None = None
    """The number of tiles along each component of the observation, or one number for all."""
    hashed_rows: int | None = None
    """The number of rows that all tiles share by hashing, for tilings too large for memory. None gives each tile a row
    of its own."""
    bins: tuple[int, ...] | None = None
    """The number of bins along each component of the observation, or one number for all."""
    edges: tuple[tuple[float, ...], ...] | None = None
    """The inner edges between the bins of each component of the observation, ascending, as np.digitize takes them."""
    low: tuple[float, ...] | None = None
    """The lower limits of the bins or tilings, one for each component of the observation. None takes those of the
    observation space. What lies outside the limits falls into the outermost bin or tile."""
    high: tuple[float, ...] | None = None
    """The upper limits of the bins or tilings, like low."""
    actions: int | tuple[float | tuple[float, ...], ...] | None = None
    """The actions to choose from if the action space is a Box: the number of evenly spaced values along each component,
    from low to high, or the actions themselves."""

    if TYPE_CHECKING:
        # For type checkers, which would otherwise expect the types that are stored, not those that may be given.
        def __init__(self, env: str = ..., **settings: Unpack[Settings]) -> None: ...

    def __post_init__(self) -> None:
        """Checks the values and turns NumPy's numbers into Python's."""
        vars(self).update(validated(vars(self)))

    def __eq__(self, other: object) -> bool:
        """Whether all settings are equal, those that are arrays in every byte."""
        if not isinstance(other, Config):
            return NotImplemented
        return all(_comparable(value) == _comparable(getattr(other, name)) for name, value in vars(self).items())

    def __hash__(self) -> int:
        """The hash of the settings, without those whose values may not have one."""
        unhashable = ("env_kwargs", "initial_q", "discretizer")
        return hash(tuple(value for name, value in vars(self).items() if name not in unhashable))

    def _repr_html_(self) -> str:
        """The settings that apply as a table, for notebooks."""
        given = {name: value for name, value in vars(self).items() if value is not None}
        if not self.env_kwargs:
            del given["env_kwargs"]
        shown = {name: _short(value) for name, value in given.items()}
        return html.summary(f"Config of {self.env}", shown)

    def replace(self, **changes: "Unpack[ConfigSettings]") -> "Config":
        """Returns a copy with some settings changed.

        With another ``env``, the config of a run loses its preset, the settings that training derived from the old
        environment, and the arguments with which the old id is registered.

        Raises:
            TypeError: for an unknown setting, or a value of the wrong type.
            ValueError: for a value that is out of range, or that does not apply beside the others.
        """
        check_names(changes, DEFAULTS)
        given, origin = with_followers(self, changes, DEFAULTS)
        return copied(replace(self, **given), origin)


DEFAULTS: Mapping[str, Any] = {
    field.name: field.default_factory() if callable(field.default_factory) else field.default
    for field in fields(Config)
}
"""The default of each field."""


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"array of shape {value.shape}"
    return repr(value)


def _comparable(value: Any) -> Any:
    """Returns what two equal values of a setting have in common: JSON, in which runs are saved, has no tuples."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, Mapping):
        return {name: _comparable(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return tuple(map(_comparable, value))
    return value


def _suggesting(init: Callable[..., None]) -> Callable[..., None]:
    """Makes the generated constructor suggest the setting that was probably meant by an unknown keyword."""

    @wraps(init)
    def checked(self: Config, *args: Any, **settings: Any) -> None:
        check_names(settings, DEFAULTS, "Config")
        algorithm = settings.get("algorithm")
        if algorithm in PREFERENCES:
            settings.setdefault("exploration", "softmax")
        settings = {**fixed_settings(algorithm), **settings}
        if settings.get("time_aware"):
            settings.setdefault("on_truncation", "terminate")
        settings.update(implied_schedules(settings, {**DEFAULTS, **settings}))
        init(self, *args, **settings)

    return checked


setattr(Config, "__init__", _suggesting(Config.__init__))  # noqa: B010 - type checkers refuse the assignment


def replace_checked(config: Config, **changes: Any) -> Config:
    """Returns a copy with some fields changed, for values that are known to be valid: they are not checked again."""
    changed = copied(config, config.origin)
    vars(changed).update(changes)
    return changed
