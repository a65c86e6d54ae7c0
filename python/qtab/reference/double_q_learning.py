"""Double Q-learning in plain NumPy (Sutton & Barto, 2nd ed., section 6.7)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.reference.parts.task import Result, Task, value


def double_q_learning(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`. Returns both tables in one array."""
    task = Task(env, config, stop_after)
    Q1, Q2 = task.table(0, tables=2), task.table(1, tables=2)
    rate1, rate2 = task.learning_rate, task.new_learning_rate()

    for _ in task.episodes():
        rate2.schedule.value = rate1.schedule.value
        state, over = task.reset(), False
        while not over:
            action = task.policy.choose(task.values(Q1, state) + task.values(Q2, state), state)
            step = task.step(action)

            # A coin decides which table learns:
            # Q1(S, A) <- Q1(S, A) + α [R + γ Q2(S', argmax Q1(S', a)) - Q1(S, A)], or the same with both exchanged.
            Q, other, rate = (Q1, Q2, rate1) if task.rng.random() < 0.5 else (Q2, Q1, rate2)
            following = None
            if not step.terminal:
                following = value(other, step.state, int(np.argmax(task.values(Q, step.state))))
            task.learn(Q, state, action, step.reward, following, rate=rate)

            state, over = step.state, step.over

    return task.result(Q1, Q2)
