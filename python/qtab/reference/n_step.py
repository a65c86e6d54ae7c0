"""n-step Sarsa, tree backup and Q(σ) in plain NumPy (Sutton & Barto, 2nd ed., boxes in sections 7.2, 7.5 and 7.6)."""

from collections.abc import Callable

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.parts.task import Result, Rows, Table, Task, value
from qtab.reference.sarsa import expected_value


def n_step_sarsa(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    n = algorithm_options(config).n_steps
    Q = task.table()

    for _ in task.episodes():
        states, rewards = [task.reset()], [0.0]
        actions = [task.choose(Q, states[0])]
        t, last_step, terminal = 0, None, False
        tau = 1 - n
        while last_step is None or tau < last_step:
            if last_step is None:
                step = task.step(actions[t])
                states.append(step.state)
                rewards.append(step.reward)
                if step.over:
                    last_step, terminal = t + 1, step.terminal
                if not step.terminal:
                    actions.append(task.choose(Q, step.state))

            # G = R(τ+1) + γ R(τ+2) + … + γ^n Q(S(τ+n), A(τ+n)), the last term unless nothing follows there.
            tau = t - n + 1
            if tau >= 0:
                end = tau + n if last_step is None else min(tau + n, last_step)
                target, power = 0.0, 1.0
                for reward in rewards[tau + 1 : end + 1]:
                    target += power * reward
                    power *= task.discount
                following = None
                if not (terminal and end == last_step):
                    following = value(Q, states[end], actions[end])
                    target += power * following
                task.observer.target(tau, rewards[tau + 1 : end + 1], following)
                task.update(Q, states[tau], actions[tau], target)
            t += 1
            tau += 1

    return task.result(Q)


Weight = Callable[[float, float], float]
"""Returns the weight of the return after A from π(A | S) and the importance sampling ratio ρ."""


def n_step_backups(env: gym.Env, config: Config, stop_after: int | None, weight: Weight) -> Result:
    """Trains towards returns over n steps. The target policy π is greedy, or else the behaviour policy."""
    task = Task(env, config, stop_after)
    options = algorithm_options(config)
    n, greedy = options.n_steps, options.target_policy == "greedy"
    Q = task.table()

    def chosen(state: Rows) -> tuple[int, float]:
        """Returns an action by the behaviour policy b, and ρ = π(A | S) / b(A | S)."""
        values = task.values(Q, state)
        action = task.policy.choose(values, state)
        ratio = (
            probability(task, Q, state, action, greedy) / task.policy.probabilities(values, state)[action]
            if greedy
            else 1.0
        )
        return action, ratio

    for _ in task.episodes():
        states, rewards = [task.reset()], [0.0]
        action, ratio = chosen(states[0])
        actions, ratios = [action], [ratio]
        t, last_step, terminal = 0, None, False
        tau = 1 - n
        while last_step is None or tau < last_step:
            if last_step is None:
                step = task.step(actions[t])
                states.append(step.state)
                rewards.append(step.reward)
                if step.over:
                    last_step, terminal = t + 1, step.terminal
                if not step.terminal:  # at a time-out, drawn but not taken
                    action, ratio = chosen(step.state)
                    actions.append(action)
                    ratios.append(ratio)

            tau = t - n + 1
            if tau >= 0:
                end = tau + n if last_step is None else min(tau + n, last_step)
                G, following = 0.0, None
                for k in range(end, tau, -1):
                    if k < end:
                        share = probability(task, Q, states[k], actions[k], greedy)
                        correction = weight(share, ratios[k]) * (G - value(Q, states[k], actions[k]))
                        following = expected(task, Q, states[k], greedy) + correction
                    elif not (terminal and end == last_step):  # nothing follows a terminal state
                        following = expected(task, Q, states[k], greedy)
                    G = rewards[k] if following is None else rewards[k] + task.discount * following
                task.observer.target(tau, (rewards[tau + 1],), following)
                task.update(Q, states[tau], actions[tau], G)
            t += 1
            tau += 1

    return task.result(Q)


def expected(task: Task, Q: Table, state: Rows, greedy: bool) -> float:
    """Returns Σ π(a | S) Q(S, a)."""
    return float(np.max(task.values(Q, state))) if greedy else expected_value(task, Q, state)


def probability(task: Task, Q: Table, state: Rows, action: int, greedy: bool) -> float:
    """Returns π(A | S). An action that ties for the maximum is greedy."""
    values = task.values(Q, state)
    return float(values[action] == np.max(values)) if greedy else task.policy.probabilities(values, state)[action]


def n_step_tree_backup(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    return n_step_backups(env, config, stop_after, lambda share, _ratio: share)


def n_step_q_sigma(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    sigma: float = algorithm_options(config).sigma
    return n_step_backups(env, config, stop_after, lambda share, ratio: sigma * ratio + (1.0 - sigma) * share)
