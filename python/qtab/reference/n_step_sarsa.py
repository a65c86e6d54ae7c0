"""n-step Sarsa in plain NumPy (Sutton & Barto, 2nd ed., the box in section 7.2)."""

import gymnasium as gym

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.task import Result, Task, value


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
