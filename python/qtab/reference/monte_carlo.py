"""On-policy first-visit Monte Carlo control in plain NumPy (Sutton & Barto, 2nd ed., the box in section 5.4)."""

import gymnasium as gym

from qtab.config import Config
from qtab.reference.task import Result, Rows, Table, Task, value


def monte_carlo(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    Q = task.table()

    for _ in task.episodes():
        state = task.reset()
        first_visits(task, Q, state, task.choose(Q, state))

    return task.result(Q)


def first_visits(task: Task, Q: Table, state: Rows, action: int) -> None:
    """Completes an episode from its first state and action, and learns from its returns."""
    pairs, rewards, over, terminal = [], [], False, False
    while not over:
        pairs.append((state[0], action))
        step = task.step(action)
        rewards.append(step.reward)
        state, over, terminal = step.state, step.over, step.terminal
        if not terminal:
            action = task.choose(Q, state)

    # After a time-out, the value of an action that is drawn, but not taken, replaces the missing return.
    G = 0.0 if terminal else value(Q, state, action)
    for t in reversed(range(len(pairs))):
        following = None if terminal and t == len(pairs) - 1 else G
        G = task.discount * G + rewards[t]
        task.observer.returned(t, G)
        if pairs.index(pairs[t]) == t:
            task.observer.target(t, (rewards[t],), following)
            row, past_action = pairs[t]
            task.update(Q, [row], past_action, G)
