"""Prioritized sweeping in plain NumPy (Sutton & Barto, 2nd ed., the box in section 8.4)."""

import heapq

import gymnasium as gym

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.dyna_q import largest
from qtab.reference.parts.task import Result, Rows, Task

Pair = tuple[int, int]
"""A row and an action."""


def prioritized_sweeping(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    options = algorithm_options(config)
    Q = task.table()
    # Model(S, A) = R, S' (None after a terminal state), and the pairs predicted to lead to each state.
    model: dict[Pair, tuple[float, Rows | None]] = {}
    predecessors: dict[int, set[Pair]] = {}
    # The queue, by highest priority, then by the order of the table; entries no longer in `priorities` are ignored.
    queue: list[tuple[float, Pair]] = []
    priorities: dict[Pair, float] = {}

    def insert(pair: Pair) -> None:
        """Inserts a pair with the size of its error, if that is large enough; the higher of two priorities counts."""
        (row, action), (reward, next_state) = pair, model[pair]
        following = largest(task, Q, next_state)
        target = reward if following is None else reward + task.discount * following
        priority = abs(target - float(Q[row, action]))
        if priority > options.priority_threshold and priority > priorities.get(pair, 0.0):
            priorities[pair] = priority
            heapq.heappush(queue, (-priority, pair))

    def first() -> Pair | None:
        """Takes the first pair out of the queue."""
        while queue:
            priority, pair = heapq.heappop(queue)
            if priorities.get(pair) == -priority:
                del priorities[pair]
                return pair
        return None

    for _ in task.episodes():
        state, over = task.reset(), False
        while not over:
            action = task.choose(Q, state)
            step = task.step(action)
            next_state = None if step.terminal else step.state
            pair = state[0], action
            _, before = model.get(pair, (0.0, None))
            if before is not None:
                predecessors[before[0]].discard(pair)
            if next_state is not None:
                predecessors.setdefault(next_state[0], set()).add(pair)
            model[pair] = step.reward, next_state
            insert(pair)

            for _ in range(options.planning_steps):
                planned = first()
                if planned is None:
                    break
                row, past_action = planned
                reward, following = model[planned]
                task.learn(Q, [row], past_action, reward, largest(task, Q, following), planned=True)
                for predecessor in predecessors.get(row, ()):
                    insert(predecessor)

            state, over = step.state, step.over

    return task.result(Q)
