"""Monte Carlo control in plain NumPy (Sutton & Barto, 2nd ed., the boxes in sections 5.3, 5.4 and 5.7)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.reference.parts.task import Result, Rows, Table, Task, value


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


def monte_carlo_es(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`. The first action of every episode is random."""
    task = Task(env, config, stop_after)
    Q = task.table()

    for _ in task.episodes():
        state = task.reset()
        valid = task.valid_actions(Q, state)
        action = valid[int(task.rng.integers(0, len(valid)))]
        task.observer.exploring_start(task.values(Q, state), action, len(valid))
        first_visits(task, Q, state, action)

    return task.result(Q)


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
