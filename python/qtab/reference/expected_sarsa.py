"""Expected Sarsa in plain NumPy (Sutton & Barto, 2nd ed., section 6.6)."""

import math

import gymnasium as gym

from qtab.config import Config
from qtab.reference.task import Result, Task


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
            if step.terminal:
                task.end(Q, state, action, step.reward)
            else:
                next_values = task.values(Q, step.state)
                shares = zip(task.policy.probabilities(next_values, step.state), next_values, strict=True)
                terms = [p * float(q) for p, q in shares if (p, q) != (0.0, -math.inf)]
                expected = terms[0]
                for term in terms[1:]:
                    expected += term
                task.update(Q, state, action, step.reward + task.discount * expected)

            state, over = step.state, step.over

    return task.result(Q)
