"""REINFORCE in plain NumPy (Sutton & Barto, 2nd ed., the boxes in sections 13.3 and 13.4)."""

import gymnasium as gym

from qtab.config import Config
from qtab.reference.policy_gradient import Critic, ascend
from qtab.reference.task import Result, Rows, Task


def reinforce(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`. The table holds preferences."""
    return _reinforce(Task(env, config, stop_after), with_baseline=False)


def reinforce_with_baseline(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains with state values as a baseline, which are the second table: one value per row, in every column."""
    return _reinforce(Task(env, config, stop_after), with_baseline=True)


def _reinforce(task: Task, *, with_baseline: bool) -> Result:
    theta = task.table(0, tables=2 if with_baseline else 1)
    critic = Critic(task) if with_baseline else None

    for _ in task.episodes():
        state, over = task.reset(), False
        visits: list[tuple[Rows, int]] = []
        rewards: list[float] = []
        while not over:
            action = task.choose(theta, state)
            step = task.step(action)
            visits.append((state, action))
            rewards.append(step.reward)
            state, over = step.state, step.over

        # G_t = R_(t+1) + γ G_(t+1)
        returns = [0.0] * (len(rewards) + 1)
        for time in reversed(range(len(rewards))):
            returns[time] = rewards[time] + task.discount * returns[time + 1]

        power = 1.0  # γ^t
        for t, (state, action) in enumerate(visits):
            error, reference = returns[t], 0.0
            if critic is not None:
                reference = critic.value(state)
            task.observer.returned(t, returns[t])
            task.observer.target(t, (), None)
            task.observer.advantage(state, returns[t], reference, power)
            if critic is not None:
                # δ = G - v(S, w), w <- w + α δ ∇v(S, w)
                error -= reference
                critic.update(state, error)
            # θ <- θ + α γ^t δ ∇ ln π(A | S, θ)
            ascend(task, theta, state, action, power * error)
            power *= task.discount

    return task.result(theta) if critic is None else task.result(theta, critic.w)
