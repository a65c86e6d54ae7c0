"""The learning algorithms, each with the options that it has."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import cast

from typing_extensions import Self

from qtab._spec import AlgorithmSpec
from qtab._utils.checks import required
from qtab.config.choices import Algorithm, ModelKind, TargetPolicy, Traces
from qtab.config.config import Config


@dataclass(frozen=True)
class AlgorithmSettings:
    """An algorithm; as such one without options. The fields of a subclass are options of :class:`qtab.Config`."""

    name: Algorithm

    @classmethod
    def of(cls, config: Config) -> Self:
        """Returns the algorithm of a complete config.

        Raises:
            ValueError: if one of its options is None.
        """
        options = {field.name: required(field.name, getattr(config, field.name)) for field in fields(cls)[1:]}
        return cls(config.algorithm, **options)

    def spec(self) -> AlgorithmSpec:
        """Returns the algorithm as the extension takes it."""
        options = {field.name: getattr(self, field.name) for field in fields(self)[1:]}
        return cast("AlgorithmSpec", {"type": self.name, **options})


@dataclass(frozen=True)
class NStepSarsa(AlgorithmSettings):
    """n-step Sarsa."""

    n_steps: int


@dataclass(frozen=True)
class EligibilityTraces(AlgorithmSettings):
    """Sarsa(λ) or Watkins's Q(λ)."""

    trace_decay: float
    traces: Traces
    trace_cutoff: float


@dataclass(frozen=True)
class TrueOnlineSarsaLambda(AlgorithmSettings):
    """True online Sarsa(λ), whose traces are always dutch."""

    trace_decay: float
    trace_cutoff: float


@dataclass(frozen=True)
class DynaQ(AlgorithmSettings):
    """Dyna-Q."""

    planning_steps: int
    model: ModelKind


@dataclass(frozen=True)
class DynaQPlus(AlgorithmSettings):
    """Dyna-Q+."""

    planning_steps: int
    time_weight: float


@dataclass(frozen=True)
class NStepTreeBackup(AlgorithmSettings):
    """n-step tree backup."""

    n_steps: int
    target_policy: TargetPolicy


@dataclass(frozen=True)
class NStepQSigma(AlgorithmSettings):
    """n-step Q(σ)."""

    n_steps: int
    sigma: float
    target_policy: TargetPolicy


@dataclass(frozen=True)
class PrioritizedSweeping(AlgorithmSettings):
    """Prioritized sweeping."""

    planning_steps: int
    priority_threshold: float


@dataclass(frozen=True)
class Differential(AlgorithmSettings):
    """Differential Sarsa or differential Q-learning."""

    reward_learning_rate: float


@dataclass(frozen=True)
class GradientBandit(AlgorithmSettings):
    """The gradient bandit algorithm."""

    baseline: bool


@dataclass(frozen=True)
class WithStateValues(AlgorithmSettings):
    """REINFORCE with baseline, or one-step actor-critic."""

    value_learning_rate: float


@dataclass(frozen=True)
class ActorCriticLambda(AlgorithmSettings):
    """Actor-critic with eligibility traces."""

    value_learning_rate: float
    trace_decay: float


ALGORITHMS: Mapping[Algorithm, type[AlgorithmSettings]] = {
    "q_learning": AlgorithmSettings,
    "sarsa": AlgorithmSettings,
    "expected_sarsa": AlgorithmSettings,
    "double_q_learning": AlgorithmSettings,
    "n_step_sarsa": NStepSarsa,
    "sarsa_lambda": EligibilityTraces,
    "true_online_sarsa_lambda": TrueOnlineSarsaLambda,
    "watkins_q_lambda": EligibilityTraces,
    "dyna_q": DynaQ,
    "dyna_q_plus": DynaQPlus,
    "monte_carlo": AlgorithmSettings,
    "monte_carlo_es": AlgorithmSettings,
    "off_policy_monte_carlo": AlgorithmSettings,
    "n_step_tree_backup": NStepTreeBackup,
    "n_step_q_sigma": NStepQSigma,
    "prioritized_sweeping": PrioritizedSweeping,
    "differential_sarsa": Differential,
    "differential_q_learning": Differential,
    "gradient_bandit": GradientBandit,
    "reinforce": AlgorithmSettings,
    "reinforce_with_baseline": WithStateValues,
    "actor_critic": WithStateValues,
    "actor_critic_lambda": ActorCriticLambda,
}
"""The settings of each algorithm."""


def algorithm_settings(config: Config) -> AlgorithmSettings:
    """Returns the algorithm of a complete config.

    Raises:
        ValueError: if one of its options is None.
    """
    return ALGORITHMS[config.algorithm].of(config)
