"""Policies that read observations, in plain NumPy."""

from collections.abc import Callable
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np

from qtab.prediction.observation_policies import GreedyPolicy, ObservationPolicy, TablePolicy
from qtab.reference.parts.observations import discretizer
from qtab.reference.parts.task import values

Answer: TypeAlias = int | list[float]
"""An action, which is not sampled, or the probabilities of all actions."""
Policy: TypeAlias = Callable[[Any, list[int]], Answer]
"""A function from an observation and its active rows to an answer."""


def policy_of(given: ObservationPolicy, env: gym.Env) -> Policy:
    """Returns a policy as a function."""
    if isinstance(given, TablePolicy):
        return _of_table(given)
    if isinstance(given, GreedyPolicy):
        return _greedy(given, env)

    def answer(observation: Any, _rows: list[int]) -> Answer:
        found = given.function(observation)
        if np.ndim(found) == 0:
            return int(found) - given.actions.first
        return [float(probability) for probability in found]

    return answer


def _of_table(given: TablePolicy) -> Policy:
    table = given.probabilities
    is_deterministic = bool((np.count_nonzero(table, axis=1) == 1).all())

    def answer(_observation: Any, rows: list[int]) -> Answer:
        probabilities = table[rows[0] if len(table) > 1 else 0]
        return int(np.flatnonzero(probabilities)[0]) if is_deterministic else probabilities.tolist()

    return answer


def _greedy(given: GreedyPolicy, env: gym.Env) -> Policy:
    cells = discretizer(env, given.run.config)

    def answer(observation: Any, _rows: list[int]) -> Answer:
        active = cells.rows(observation)
        first, *others = (values(table, active) for table in given.tables)
        total = first
        for other in others:
            total = total + other
        return int(np.argmax(total))

    return answer


def probability(answer: Answer, action: int) -> float:
    """Returns π(a|s)."""
    return float(answer == action) if isinstance(answer, int) else answer[action]


def sampled(answer: Answer, rng: Any) -> int:
    """Returns an action: the first whose cumulative probability exceeds one ``random()``."""
    if isinstance(answer, int):
        return answer
    possible = [action for action, probability in enumerate(answer) if probability > 0.0]
    random, total = rng.random(), 0.0
    for action in possible:
        total += answer[action]
        if random < total:
            return action
    return possible[-1]
