"""The possible values of settings: the only list of the algorithms, schedules and discretizers in Python."""

from collections.abc import Mapping
from typing import Literal, TypeAlias, get_args

Algorithm: TypeAlias = Literal[
    "q_learning",
    "sarsa",
    "expected_sarsa",
    "double_q_learning",
    "n_step_sarsa",
    "sarsa_lambda",
    "true_online_sarsa_lambda",
    "watkins_q_lambda",
    "dyna_q",
    "dyna_q_plus",
    "monte_carlo",
    "monte_carlo_es",
    "off_policy_monte_carlo",
    "n_step_tree_backup",
    "n_step_q_sigma",
    "prioritized_sweeping",
    "differential_sarsa",
    "differential_q_learning",
    "gradient_bandit",
    "reinforce",
    "reinforce_with_baseline",
    "actor_critic",
    "actor_critic_lambda",
]
ALGORITHM_NAMES: Mapping[str, str] = {
    "q_learning": "Q-learning",
    "sarsa": "Sarsa",
    "expected_sarsa": "Expected Sarsa",
    "double_q_learning": "Double Q-learning",
    "n_step_sarsa": "n-step Sarsa",
    "sarsa_lambda": "Sarsa(λ)",
    "true_online_sarsa_lambda": "true online Sarsa(λ)",
    "watkins_q_lambda": "Watkins's Q(λ)",
    "dyna_q": "Dyna-Q",
    "dyna_q_plus": "Dyna-Q+",
    "monte_carlo": "Monte Carlo control",
    "monte_carlo_es": "Monte Carlo ES",
    "off_policy_monte_carlo": "off-policy Monte Carlo control",
    "n_step_tree_backup": "n-step tree backup",
    "n_step_q_sigma": "n-step Q(σ)",
    "prioritized_sweeping": "prioritized sweeping",
    "differential_sarsa": "differential Sarsa",
    "differential_q_learning": "differential Q-learning",
    "gradient_bandit": "gradient bandit",
    "reinforce": "REINFORCE",
    "reinforce_with_baseline": "REINFORCE with baseline",
    "actor_critic": "one-step actor-critic",
    "actor_critic_lambda": "actor-critic with eligibility traces",
}
"""The names of the algorithms as in Sutton & Barto, for titles and tables."""

LearningRateSchedule: TypeAlias = Literal["constant", "linear", "exponential", "visits"]
Exploration: TypeAlias = Literal["epsilon_greedy", "softmax", "ucb"]
EpsilonSchedule: TypeAlias = Literal["constant", "linear", "exponential"]
Ties: TypeAlias = Literal["first", "random"]
Traces: TypeAlias = Literal["accumulating", "replacing", "clearing"]
TargetPolicy: TypeAlias = Literal["greedy", "behavior"]
ModelKind: TypeAlias = Literal["deterministic", "stochastic"]
DiscretizerName: TypeAlias = Literal[
    "round", "bins", "edges", "tiles", "fourier", "polynomial", "radial", "coarse", "identity"
]
TerminalUpdate: TypeAlias = Literal["target", "assign"]
OnTruncation: TypeAlias = Literal["bootstrap", "terminate"]
BitGenerator: TypeAlias = Literal["PCG64", "MT19937"]
Backend: TypeAlias = Literal["auto", "rust", "gymnasium", "numba", "python"]

IN_PYTHON = ("gymnasium", "python")
"""The backends that step the environment in Python."""
INSISTING = ("rust", "numba")
"""The backends that raise an error if Rust cannot step the environment."""

CHOICES: Mapping[str, tuple[str, ...]] = {
    "algorithm": get_args(Algorithm),
    "learning_rate_schedule": get_args(LearningRateSchedule),
    "exploration": get_args(Exploration),
    "epsilon_schedule": get_args(EpsilonSchedule),
    "ties": get_args(Ties),
    "traces": get_args(Traces),
    "target_policy": get_args(TargetPolicy),
    "model": get_args(ModelKind),
    "discretizer": get_args(DiscretizerName),
    "terminal_update": get_args(TerminalUpdate),
    "on_truncation": get_args(OnTruncation),
    "bit_generator": get_args(BitGenerator),
    "backend": get_args(Backend),
}
"""The possible values of each setting."""

FUNCTION = "function"
MAPPING = "mapping"
"""The kinds of discretizers without a name."""
