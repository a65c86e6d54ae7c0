"""The gradient bandit algorithm in plain NumPy (Sutton & Barto, 2nd ed., section 2.8)."""

import gymnasium as gym

from qtab._utils.checks import required
from qtab.config import Config
from qtab.reference.policy_gradient import ascend
from qtab.reference.task import Result, Task


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
