"""Off-policy Monte Carlo control in plain NumPy (Sutton & Barto, 2nd ed., the box in section 5.7)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.reference.task import Result, Rows, Table, Task


def off_policy_monte_carlo(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    Q = task.table()
    C = np.zeros(Q.shape)
    least = config.min_learning_rate or 0.0

    for _ in task.episodes():
        state, over, terminal = task.reset(), False, False
        steps = []
        while not over:
            action, probability = choose(task, Q, state)
            step = task.step(action)
            steps.append((state[0], action, step.reward, probability))
            state, over, terminal = step.state, step.over, step.terminal

        # After a time-out, the largest value replaces the missing return.
        G = 0.0 if terminal else float(np.max(task.values(Q, state)))
        W = 1.0
        for t in reversed(range(len(steps))):
            row, action, reward, probability = steps[t]
            following = None if terminal and t == len(steps) - 1 else G
            G = task.discount * G + reward
            task.observer.returned(t, G)
            C[row, action] += W
            # Q(S, A) <- Q(S, A) + α W / C [G - Q(S, A)], where α is 1 in the book; the step has a minimum.
            step_size = max(config.learning_rate * W / float(C[row, action]), least)
            task.observer.target(t, (reward,), following)
            task.move(Q, [row], action, G, [step_size])
            if action != int(np.argmax(task.values(Q, [row]))):
                break
            W /= probability

    return task.result(Q)


def choose(task: Task, Q: Table, state: Rows) -> tuple[int, float]:
    """Returns an action by the behaviour policy b, and b(A | S)."""
    values = task.values(Q, state)
    action = task.policy.choose(values, state)
    return action, task.policy.probabilities(values, state)[action]
