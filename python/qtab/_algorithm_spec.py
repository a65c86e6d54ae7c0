"""What the extension module takes of algorithms: each with its own options, tagged by ``type``."""

from typing import Literal, TypeAlias, TypedDict

from qtab.config.choices import ModelKind, TargetPolicy, Traces


class PlainSpec(TypedDict):
    """An algorithm without options."""

    type: Literal[
        "q_learning",
        "sarsa",
        "expected_sarsa",
        "double_q_learning",
        "monte_carlo",
        "monte_carlo_es",
        "off_policy_monte_carlo",
        "reinforce",
    ]


class NStepSarsaSpec(TypedDict):
    """n-step Sarsa."""

    type: Literal["n_step_sarsa"]
    n_steps: int


class TraceSpec(TypedDict):
    """An algorithm with eligibility traces of a kind."""

    type: Literal["sarsa_lambda", "watkins_q_lambda"]
    trace_decay: float
    traces: Traces
    trace_cutoff: float


class TrueOnlineSarsaLambdaSpec(TypedDict):
    """True online Sarsa(lambda), whose traces are of its own kind."""

    type: Literal["true_online_sarsa_lambda"]
    trace_decay: float
    trace_cutoff: float


class DynaQSpec(TypedDict):
    """Dyna-Q."""

    type: Literal["dyna_q"]
    planning_steps: int
    model: ModelKind


class DynaQPlusSpec(TypedDict):
    """Dyna-Q+."""

    type: Literal["dyna_q_plus"]
    planning_steps: int
    time_weight: float


class NStepTreeBackupSpec(TypedDict):
    """n-step tree backup."""

    type: Literal["n_step_tree_backup"]
    n_steps: int
    target_policy: TargetPolicy


class NStepQSigmaSpec(TypedDict):
    """n-step Q(sigma)."""

    type: Literal["n_step_q_sigma"]
    n_steps: int
    sigma: float
    target_policy: TargetPolicy


class PrioritizedSweepingSpec(TypedDict):
    """Prioritized sweeping."""

    type: Literal["prioritized_sweeping"]
    planning_steps: int
    priority_threshold: float


class DifferentialSpec(TypedDict):
    """An algorithm for the average reward."""

    type: Literal["differential_sarsa", "differential_q_learning"]
    reward_learning_rate: float


class GradientBanditSpec(TypedDict):
    """The gradient bandit algorithm."""

    type: Literal["gradient_bandit"]
    baseline: bool


class StateValuesSpec(TypedDict):
    """A policy gradient method that learns state values beside the policy."""

    type: Literal["reinforce_with_baseline", "actor_critic"]
    value_learning_rate: float


class ActorCriticLambdaSpec(TypedDict):
    """Actor-critic with eligibility traces."""

    type: Literal["actor_critic_lambda"]
    value_learning_rate: float
    trace_decay: float


AlgorithmSpec: TypeAlias = (
    PlainSpec
    | NStepSarsaSpec
    | TraceSpec
    | TrueOnlineSarsaLambdaSpec
    | DynaQSpec
    | DynaQPlusSpec
    | NStepTreeBackupSpec
    | NStepQSigmaSpec
    | PrioritizedSweepingSpec
    | DifferentialSpec
    | GradientBanditSpec
    | StateValuesSpec
    | ActorCriticLambdaSpec
)
