"""Policy gradient methods without a one-step critic, in plain NumPy: the gradient bandit and REINFORCE.

Sutton & Barto, 2nd ed., section 2.8, and the boxes in sections 13.3 and 13.4.
"""

import gymnasium as gym
import numpy as np

from qtab._utils.checks import required
from qtab.config import Config
from qtab.reference.parts.task import Result, Rows, Table, Task, features, value


def log_gradient(task: Task, theta: Table, state: Rows, action: int) -> list[float]:
    """Returns the gradient of ln π(A | S) for the preference of each action; for the weight of a row, it is times x."""
    temperature = required("temperature", task.config.temperature)
    probabilities = task.policy.probabilities(task.values(theta, state), state)
    return [((other == action) - share) / temperature for other, share in enumerate(probabilities)]


def ascend(task: Task, theta: Table, state: Rows, action: int, scale: float) -> None:
    """Updates θ <- θ + α scale ∇ ln π(A | S, θ); the active rows of S share the step."""
    gradient = log_gradient(task, theta, state, action)
    task.observer.before_ascent(theta, state, action, step_sizes(task, state), gradient, None)
    for row, x, step_size in zip(state, features(state), step_sizes(task, state), strict=True):
        for other, part in enumerate(gradient):
            theta[row, other] += step_size * scale * part * x
    task.observer.after_ascent(theta)


def step_sizes(task: Task, state: Rows) -> list[float]:
    """Returns the step size α of each active row."""
    return [float(task.learning_rate.step(row, 0)) for row in state]


class Critic:
    """State values v(S, w): the sum of the weights of the active rows, each times its feature."""

    def __init__(self, task: Task) -> None:
        # One column for each action, all equal, to store the values in the same shape as the preferences.
        self.w = task.critic_table()
        rate = required("value_learning_rate", task.config.value_learning_rate)
        self.step_sizes = rate / np.array(task.learning_rate.divisors or [task.discretizer.n_active] * task.n_rows)

    def value(self, state: Rows) -> float:
        """Returns v(S, w)."""
        return value(self.w, state, 0)

    def update(self, state: Rows, error: float) -> None:
        """Updates w <- w + α δ ∇v(S, w)."""
        for row, x in zip(state, features(state), strict=True):
            self.w[row] += self.step_sizes[row] * error * x


def gradient_bandit(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`. The table holds preferences."""
    task = Task(env, config, stop_after)
    baseline = required("baseline", config.baseline)
    H = task.table()
    average: dict[int, float] = {}
    count: dict[int, int] = {}

    for _ in task.episodes():
        state, over = task.reset(), False
        while not over:
            action = task.choose(H, state)
            step = task.step(action)

            # The average of the rewards before this one; the first reward is compared with itself.
            reference = 0.0
            if baseline:
                (row,) = state
                reference = average.setdefault(row, step.reward)
                count[row] = count.get(row, 0) + 1
                average[row] += (step.reward - reference) / count[row]
            target = task.target(step.reward, None)
            task.observer.advantage(state, target, reference, 1.0)
            # H(A) <- H(A) + α (R - R̄) (1 - π(A)), and H(a) <- H(a) - α (R - R̄) π(a) for the others
            ascend(task, H, state, action, target - reference)

            state, over = step.state, step.over

    return task.result(H)


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
