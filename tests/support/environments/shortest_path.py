"""The shortest path in a deterministic environment with a transition table."""

from collections import deque
from typing import Any

import numpy as np


def shortest_path(env: Any) -> int:
    """The fewest steps from the start to a terminal state."""
    start = int(np.argmax(env.initial_state_distrib))
    reached, queue = {start: 0}, deque([start])
    while queue:
        state = queue.popleft()
        for [(_, next_state, _, terminated)] in env.P[state].values():
            if terminated:
                return reached[state] + 1
            if next_state not in reached:
                reached[next_state] = reached[state] + 1
                queue.append(next_state)
    raise AssertionError("no terminal state can be reached")
