"""The learning algorithms, each with the options that it has."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from qtab._spec import (
    DynaQPlusSpec,
    DynaQSpec,
    NStepSarsaSpec,
    OneStepSpec,
    TraceSpec,
    TrueOnlineSarsaLambdaSpec,
)
from qtab._utils.checks import required
from qtab.config.choices import Traces
from qtab.config.config import Config


@dataclass(frozen=True)
class OneStep:
    """An algorithm without options."""

    name: Literal["q_learning", "sarsa", "expected_sarsa", "double_q_learning"]

    def spec(self) -> OneStepSpec:
        """Returns the algorithm as the extension takes it."""
        return {"type": self.name}


@dataclass(frozen=True)
class NStepSarsa:
    """n-step Sarsa."""

    n_steps: int

    @classmethod
    def of(cls, config: Config) -> "NStepSarsa":
        """Returns the options of a complete config."""
        return cls(required("n_steps", config.n_steps))

    def spec(self) -> NStepSarsaSpec:
        """Returns the algorithm as the extension takes it."""
        return {"type": "n_step_sarsa", "n_steps": self.n_steps}


@dataclass(frozen=True)
class EligibilityTraces:
    """Sarsa(λ) or Watkins's Q(λ)."""

    name: Literal["sarsa_lambda", "watkins_q_lambda"]
    trace_decay: float
    traces: Traces
    trace_cutoff: float

    @classmethod
    def of(cls, name: Literal["sarsa_lambda", "watkins_q_lambda"], config: Config) -> "EligibilityTraces":
        """Returns the options of a complete config."""
        return cls(
            name,
            required("trace_decay", config.trace_decay),
            required("traces", config.traces),
            required("trace_cutoff", config.trace_cutoff),
        )

    def spec(self) -> TraceSpec:
        """Returns the algorithm as the extension takes it."""
        return {
            "type": self.name,
            "trace_decay": self.trace_decay,
            "traces": self.traces,
            "trace_cutoff": self.trace_cutoff,
        }


@dataclass(frozen=True)
class TrueOnlineSarsaLambda:
    """True online Sarsa(λ), whose traces are always dutch."""

    trace_decay: float
    trace_cutoff: float

    @classmethod
    def of(cls, config: Config) -> "TrueOnlineSarsaLambda":
        """Returns the options of a complete config."""
        return cls(required("trace_decay", config.trace_decay), required("trace_cutoff", config.trace_cutoff))

    def spec(self) -> TrueOnlineSarsaLambdaSpec:
        """Returns the algorithm as the extension takes it."""
        return {
            "type": "true_online_sarsa_lambda",
            "trace_decay": self.trace_decay,
            "trace_cutoff": self.trace_cutoff,
        }


@dataclass(frozen=True)
class DynaQ:
    """Dyna-Q."""

    planning_steps: int

    @classmethod
    def of(cls, config: Config) -> "DynaQ":
        """Returns the options of a complete config."""
        return cls(required("planning_steps", config.planning_steps))

    def spec(self) -> DynaQSpec:
        """Returns the algorithm as the extension takes it."""
        return {"type": "dyna_q", "planning_steps": self.planning_steps}


@dataclass(frozen=True)
class DynaQPlus:
    """Dyna-Q+."""

    planning_steps: int
    time_weight: float

    @classmethod
    def of(cls, config: Config) -> "DynaQPlus":
        """Returns the options of a complete config."""
        return cls(required("planning_steps", config.planning_steps), required("time_weight", config.time_weight))

    def spec(self) -> DynaQPlusSpec:
        """Returns the algorithm as the extension takes it."""
        return {"type": "dyna_q_plus", "planning_steps": self.planning_steps, "time_weight": self.time_weight}


AlgorithmSettings: TypeAlias = OneStep | NStepSarsa | EligibilityTraces | TrueOnlineSarsaLambda | DynaQ | DynaQPlus


def algorithm_settings(config: Config) -> AlgorithmSettings:
    """Returns the algorithm of a complete config.

    Raises:
        ValueError: if one of its options is None.
    """
    name = config.algorithm
    match name:
        case "q_learning" | "sarsa" | "expected_sarsa" | "double_q_learning":
            return OneStep(name)
        case "n_step_sarsa":
            return NStepSarsa.of(config)
        case "sarsa_lambda" | "watkins_q_lambda":
            return EligibilityTraces.of(name, config)
        case "true_online_sarsa_lambda":
            return TrueOnlineSarsaLambda.of(config)
        case "dyna_q":
            return DynaQ.of(config)
        case "dyna_q_plus":
            return DynaQPlus.of(config)
