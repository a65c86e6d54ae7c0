"""Actor-critic methods in plain NumPy (Sutton & Barto, 2nd ed., the boxes in section 13.5)."""

import gymnasium as gym
import numpy as np

from qtab._utils.checks import required
from qtab.config import Config
from qtab.reference.parts.task import Result, Rows, Step, Task, features
from qtab.reference.parts.weighted import WeightedRows
from qtab.reference.policy_gradient import Critic, ascend, log_gradient, step_sizes


def actor_critic(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env`` by one-step actor-critic; see :func:`qtab.reference.reinforce_with_baseline`."""
    task = Task(env, config, stop_after)
    theta, critic = task.table(0, tables=2), Critic(task)

    for _ in task.episodes():
        state, over = task.reset(), False
        power = 1.0  # I = γ^t
        while not over:
            action = task.choose(theta, state)
            step = task.step(action)

            # w <- w + α δ ∇v(S, w), θ <- θ + α I δ ∇ ln π(A | S, θ), I <- γ I
            error = td_error(task, critic, state, step, power)
            critic.update(state, error)
            ascend(task, theta, state, action, power * error)
            power *= task.discount

            state, over = step.state, step.over

    return task.result(theta, critic.w)


def actor_critic_lambda(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env`` by actor-critic with eligibility traces, the same λ for both."""
    task = Task(env, config, stop_after)
    decay = task.discount * required("trace_decay", config.trace_decay)
    theta, critic = task.table(0, tables=2), Critic(task)

    for _ in task.episodes():
        state, over = task.reset(), False
        z_w, z_theta = np.zeros(task.n_rows), np.zeros_like(theta)
        power = 1.0
        while not over:
            action = task.choose(theta, state)
            step = task.step(action)
            error = td_error(task, critic, state, step, power)

            # z_w <- γλ z_w + ∇v(S, w), z_θ <- γλ z_θ + I ∇ ln π(A | S, θ)
            z_w *= decay
            z_theta *= decay
            gradient = log_gradient(task, theta, state, action)
            for row, x in zip(state, features(state), strict=True):
                z_w[row] += x
                for other, part in enumerate(gradient):
                    z_theta[row, other] += power * part * x
            # w <- w + α δ z_w, θ <- θ + α δ z_θ, I <- γ I
            task.observer.before_ascent(theta, state, action, step_sizes(task, state), gradient, z_theta)
            traced = np.array(state) if isinstance(state, WeightedRows) else np.nonzero(z_w)[0]
            critic.w[traced] += (critic.step_sizes[traced] * error * z_w[traced])[:, np.newaxis]
            steps = task.learning_rate.steps(traced, np.zeros_like(traced))
            theta[traced] += (steps * error)[:, np.newaxis] * z_theta[traced]
            task.observer.after_ascent(theta)
            power *= task.discount

            state, over = step.state, step.over

    return task.result(theta, critic.w)


def td_error(task: Task, critic: Critic, state: Rows, step: Step, power: float) -> float:
    """Returns δ = R + γ v(S', w) - v(S, w)."""
    following = None if step.terminal else critic.value(step.state)
    target = task.target(step.reward, following)
    task.observer.advantage(state, target, critic.value(state), power)
    return target - critic.value(state)
