"""The agent's parts of a run's description, as the extension module takes them."""

from typing import cast

import numpy as np

from qtab import _spec
from qtab.config import Config


def learning_rate(config: Config) -> _spec.LearningRateSpec:
    """Returns the learning rate of a resolved config."""
    value, minimum = config.learning_rate, config.min_learning_rate or 0.0
    if config.learning_rate_schedule == "visits":
        return {"type": "visits", "value": value, "minimum": minimum}
    return _schedule(
        config.learning_rate_schedule,
        value,
        minimum,
        config.learning_rate_decay or 0.0,
        config.learning_rate_warm_up or 0,
    )


def policy(config: Config) -> _spec.PolicySpec:
    """Returns how a resolved config chooses actions."""
    if config.temperature is not None:
        return {"type": "softmax", "temperature": config.temperature}
    assert config.epsilon is not None  # noqa: S101 - resolved
    assert config.epsilon_schedule is not None  # noqa: S101
    assert config.ties is not None  # noqa: S101
    epsilon = _schedule(
        config.epsilon_schedule,
        config.epsilon,
        config.min_epsilon or 0.0,
        config.epsilon_decay or 0.0,
        config.epsilon_warm_up or 0,
    )
    return {"type": "epsilon_greedy", "epsilon": epsilon, "ties": config.ties}


def _schedule(kind: str, value: float, minimum: float, decay: float, warm_up: int) -> _spec.ScheduleSpec:
    if kind == "constant":
        return {"type": "constant", "value": value}
    if kind == "linear":
        return {"type": "linear", "value": value, "minimum": minimum, "warm_up": warm_up}
    return {"type": "exponential", "value": value, "minimum": minimum, "decay": decay, "warm_up": warm_up}


def algorithm(config: Config) -> _spec.AlgorithmSpec:
    """Returns a resolved config's learner with its own options."""
    names = ("trace_decay", "traces", "trace_cutoff", "n_steps", "planning_steps", "time_weight")
    options = {name: getattr(config, name) for name in names if getattr(config, name) is not None}
    return cast(_spec.AlgorithmSpec, {"type": config.algorithm, **options})


def initial_q(config: Config) -> _spec.InitialQSpec:
    """Returns the first values of the tables."""
    if isinstance(config.initial_q, np.ndarray):
        return {"type": "table", "values": config.initial_q}
    if isinstance(config.initial_q, tuple):
        low, high = config.initial_q
        return {"type": "uniform", "low": low, "high": high}
    return {"type": "constant", "value": config.initial_q}
