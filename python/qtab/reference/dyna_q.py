"""Dyna-Q and Dyna-Q+ in plain NumPy (Sutton & Barto, 2nd ed., sections 8.2 and 8.3)."""

import math

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.parts.task import Result, Rows, Table, Task

Outcomes = dict[tuple[float, int | None], int]
"""The number of times that each reward and next row followed a state and action."""


def dyna_q(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    options = algorithm_options(config)
    Q = task.table()
    # Model(S, A) = the outcomes R, S' (None after a terminal state), and their counts. Dicts keep the order of first
    # visits, first tries and first outcomes. A deterministic model keeps only the last outcome.
    model: dict[int, dict[int, Outcomes]] = {}

    for _ in task.episodes():
        state, over = task.reset(), False
        while not over:
            action = task.choose(Q, state)
            step = task.step(action)
            next_state = None if step.terminal else step.state
            task.learn(Q, state, action, step.reward, largest(task, Q, next_state))
            outcomes = model.setdefault(state[0], {}).setdefault(action, {})
            if options.model == "deterministic":
                outcomes.clear()
            outcome = step.reward, None if next_state is None else next_state[0]
            outcomes[outcome] = outcomes.get(outcome, 0) + 1

            for _ in range(options.planning_steps):
                row = list(model)[int(task.rng.integers(0, len(model)))]
                tried = list(model[row])
                past_action = tried[int(task.rng.integers(0, len(tried)))]
                reward, after = sample(task, model[row][past_action])
                following = largest(task, Q, None if after is None else [after])
                task.learn(Q, [row], past_action, reward, following, planned=True)

            state, over = step.state, step.over

    return task.result(Q)


def sample(task: Task, outcomes: Outcomes) -> tuple[float, int | None]:
    """Returns a random outcome, each with its relative frequency so far."""
    left = int(task.rng.integers(0, sum(outcomes.values())))
    for outcome, count in outcomes.items():
        if left < count:
            return outcome
        left -= count
    raise AssertionError("the counts are those of the outcomes")


def largest(task: Task, Q: Table, next_state: Rows | None) -> float | None:
    """Returns max Q(S', a); None if S' is terminal."""
    return None if next_state is None else float(np.max(task.values(Q, next_state)))


def dyna_q_plus(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    options = algorithm_options(config)
    Q = task.table()
    # Model(S, A) = R, S' (None after a terminal state); an untried action leads back to S with a reward of zero.
    model: dict[int, dict[int, tuple[float, Rows | None]]] = {}
    last_tried = np.zeros(Q.shape, dtype=int)
    now = 0

    for _ in task.episodes():
        state, over = task.reset(), False
        while not over:
            action = task.choose(Q, state)
            step = task.step(action)
            next_state = None if step.terminal else step.state
            now += 1
            last_tried[state[0], action] = now
            task.learn(Q, state, action, step.reward, largest(task, Q, next_state))
            model.setdefault(state[0], {})[action] = (step.reward, next_state)

            for _ in range(options.planning_steps):
                row = list(model)[int(task.rng.integers(0, len(model)))]
                valid = task.valid_actions(Q, [row])
                any_action = valid[int(task.rng.integers(0, len(valid)))]
                reward, after = model[row].get(any_action, (0.0, [row]))
                # The reward grows with the time since the pair was last tried: R + κ √τ
                bonus = options.time_weight * math.sqrt(now - int(last_tried[row, any_action]))
                task.learn(Q, [row], any_action, reward + bonus, largest(task, Q, after), planned=True)

            state, over = step.state, step.over

    return task.result(Q)
