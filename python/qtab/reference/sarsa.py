"""Sarsa and Expected Sarsa in plain NumPy (Sutton & Barto, 2nd ed., sections 6.4 and 6.6)."""

import math

import gymnasium as gym

from qtab.config import Config
from qtab.reference.parts.task import Result, Rows, Table, Task, value


def sarsa(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    Q = task.table()

    for _ in task.episodes():
        state, over = task.reset(), False
        action = task.choose(Q, state)
        while not over:
            step = task.step(action)

            # Q(S, A) <- Q(S, A) + α [R + γ Q(S', A') - Q(S, A)]. At a time-out A' is drawn, but not taken.
            next_action, following = action, None
            if not step.terminal:
                next_action = task.choose(Q, step.state)
                following = value(Q, step.state, next_action)
            task.learn(Q, state, action, step.reward, following)

            state, action, over = step.state, next_action, step.over

    return task.result(Q)


def expected_sarsa(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    Q = task.table()

    for _ in task.episodes():
        state, over = task.reset(), False
        while not over:
            action = task.choose(Q, state)
            step = task.step(action)

            # Q(S, A) <- Q(S, A) + α [R + γ Σ π(a | S') Q(S', a) - Q(S, A)]
            task.learn(Q, state, action, step.reward, None if step.terminal else expected_value(task, Q, step.state))

            state, over = step.state, step.over

    return task.result(Q)


def expected_value(task: Task, Q: Table, state: Rows) -> float:
    """Returns Σ π(a | S) Q(S, a), added from left to right."""
    values = task.values(Q, state)
    shares = zip(task.policy.probabilities(values, state), values, strict=True)
    first, *others = [p * float(q) for p, q in shares if (p, q) != (0.0, -math.inf)]
    for term in others:
        first += term
    return first
