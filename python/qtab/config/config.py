"""What a run is made from: every setting and its default (those of an algorithm's own options are in options.py)."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from qtab.config.choices import (
    Actions,
    Algorithm,
    Backend,
    BitGenerator,
    Discretizer,
    EpsilonSchedule,
    Exploration,
    InitialQ,
    LearningRateSchedule,
    OnTruncation,
    TerminalUpdate,
    Ties,
    Traces,
)
from qtab.config.validation import validated


@dataclass(frozen=True, eq=False)
class Config:
    """All that it takes to repeat a run.

    None means "not given"; the config of a run has the value that was used in its place, and None where a setting has
    no meaning (the trace decay of an algorithm without traces). Giving such a setting is an error.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a value that is out of range, or has no meaning beside the others.
    """

    env: str = "MountainCar-v0"
    """Gymnasium's id of the environment."""
    env_kwargs: Mapping[str, Any] = field(default_factory=dict)
    """Keyword arguments of the environment's constructor."""
    episodes: int = 5000
    """How many episodes to train."""
    algorithm: Algorithm = "q_learning"
    """How values are learned."""
    learning_rate: float = 0.2
    """α: the share of each error that an update corrects, in [0, 1]; in [0, 2] for the tilings together."""
    discount: float = 0.9
    """γ: what a reward is worth one step later, in [0, 1]."""
    learning_rate_schedule: LearningRateSchedule = "constant"
    """How the learning rate falls: from episode to episode, or with a pair's visits (learning_rate / n at the n-th)."""
    min_learning_rate: float | None = None
    """The learning rate falls no further than this (0), in [0, learning_rate]."""
    learning_rate_decay: float | None = None
    """The factor of an exponential schedule (0.999), once an episode, in [0, 1]."""
    learning_rate_warm_up: int | None = None
    """The learning rate falls only after this many episodes (0)."""
    exploration: Exploration = "epsilon_greedy"
    """How actions are chosen."""
    epsilon: float | None = None
    """ε: the exploration rate of the first episode (0.8), in [0, 1]."""
    epsilon_schedule: EpsilonSchedule | None = None
    """How the exploration rate falls from episode to episode: linearly where nothing is given."""
    min_epsilon: float | None = None
    """The exploration rate falls no further than this (0), in [0, epsilon]; linearly it gets there at the end."""
    epsilon_decay: float | None = None
    """The factor of an exponential schedule (0.999), once an episode, in [0, 1]."""
    epsilon_warm_up: int | None = None
    """The exploration rate falls only after this many episodes (0)."""
    ties: Ties | None = None
    """Which of several greedy actions: the first where nothing is given, as np.argmax has it."""
    temperature: float | None = None
    """τ: softmax chooses an action by exp(Q / τ) (1), above 0."""
    trace_decay: float | None = None
    """λ: how far back an error reaches (0.9), in [0, 1]."""
    traces: Traces | None = None
    """What a visit does to a trace: replacing (where nothing is given) sets it to 1, accumulating adds 1, clearing sets
    it to 1 and those of the other actions to 0."""
    trace_cutoff: float | None = None
    """A trace that falls to this or below is forgotten (0: none before it vanishes), in [0, 1]."""
    n_steps: int | None = None
    """n: how many rewards a target adds up (4)."""
    planning_steps: int | None = None
    """How many updates from the model follow each step (10)."""
    time_weight: float | None = None
    """κ: Dyna-Q+ adds κ √τ to the rewards of what was not tried for τ steps (0.001)."""
    discretizer: Discretizer = "round"
    """How observations become rows of the table: rounded to a grid, by bins of equal width or between your own edges,
    lit by tile coding, or as they are, which is what a discrete space gets where nothing is given."""
    scale: tuple[float, ...] = ()
    """Cells per unit of each component of the observation: (10, 100) rounds to 0.1 and 0.01."""
    tilings: int | None = None
    """How many tilings lie over each other (8), at most 32."""
    tiles: tuple[int, ...] | None = None
    """Tiles along each component of the observation, or one number for all (8)."""
    hashed_rows: int | None = None
    """Rows of a table that all tilings share, found by hashing, for what has more tiles than memory; none where nothing
    is given: each tile has a row of its own."""
    bins: tuple[int, ...] | None = None
    """Bins of equal width along each component of the observation, or one number for all (10)."""
    edges: tuple[tuple[float, ...], ...] | None = None
    """For each component of the observation the rising numbers between its bins, as np.digitize takes them."""
    low: tuple[float, ...] | None = None
    """The lower limits of tilings or bins, one for each component of the observation; the space's own where nothing is
    given. What lies beyond belongs to the outermost."""
    high: tuple[float, ...] | None = None
    """The upper limits."""
    actions: Actions | None = None
    """What a learner chooses from where the action space is a Box: so many equal steps from its low to its high along
    each component, or the actions themselves."""
    initial_q: InitialQ = (-1.0, 1.0)
    """The first Q table: drawn uniformly from a range (low, high), one number everywhere, or an array to go on from.
    In an array -inf says that a state does not have an action, which is then never chosen."""
    terminal_update: TerminalUpdate = "target"
    """At a terminal state: move towards the reward (the book's rule), or assign it (the article's)."""
    on_truncation: OnTruncation = "bootstrap"
    """At a time-out: learn from what would have followed (right), or as if nothing did (a well-known mistake)."""
    max_episode_steps: int | None = None
    """The time limit; None means the environment's own, and 10,000 where it has none."""
    seed: int | None = None
    """Seeds the environment and the agent; None draws one and records it."""
    bit_generator: BitGenerator = "PCG64"
    """The agent's stream: NumPy's default_rng, or what np.random.seed sets."""
    backend: Backend = "auto"
    """Where the environment steps: in Rust, in Gymnasium, or in Rust where it can."""
    preset: str | None = None
    """A named set of values to start from; None means the environment's own."""

    def __post_init__(self) -> None:
        """Refuses bad values and turns NumPy's numbers into Python's."""
        fields = {field.name: getattr(self, field.name) for field in dataclasses.fields(Config)}
        for name, value in validated(fields).items():
            object.__setattr__(self, name, value)

    def replace(self, **changes: Any) -> "Config":
        """Returns a copy with some fields changed.

        Raises:
            TypeError: for an unknown field.
        """
        known_fields(changes)
        return dataclasses.replace(self, **changes)


def known_fields(names: Mapping[str, Any]) -> None:
    """Refuses what is no field of the config.

    Raises:
        TypeError: names the first unknown field, and the ones there are.
    """
    fields = [field.name for field in dataclasses.fields(Config)]
    for name in names:
        if name not in fields:
            raise TypeError(f"{name!r} is no setting of a run; there are {', '.join(fields)}")
