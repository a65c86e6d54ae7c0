"""``qtab/AccessControlQueue-v0``: a continuing task (Sutton & Barto, 2nd ed., Example 10.2)."""

import math
from collections.abc import Iterator, Sequence

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.envs.tabular import TabularEnv, Transition

REJECT, ACCEPT = range(2)
"""Actions."""


class AccessControlQueueEnv(TabularEnv):
    """A queue of customers of several priorities for a number of servers.

    At each step the customer at the head of the queue is accepted, if a server is free, or rejected. An accepted
    customer pays the reward of its priority and occupies a server; a rejected one leaves with a reward of 0. Then each
    busy server becomes free with a fixed probability, and the next customer's priority is drawn at random. The task
    never ends. In state ``free * len(priorities) + p``, ``free`` servers are free, and the priority has number ``p``.

    Args:
        servers: The number of servers.
        priorities: The reward of each priority.
        free_probability: The probability that a busy server becomes free in a step.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    def __init__(
        self, servers: int = 10, priorities: Sequence[float] = (1, 2, 4, 8), free_probability: float = 0.06
    ) -> None:
        self.servers = checks.integer("servers", servers, least=1, most=1000)
        if not checks.is_sequence(priorities) or not len(priorities):
            raise ValueError(f"priorities must hold the reward of at least one priority, got {shown(priorities)}")
        self.priorities = tuple(checks.finite("priorities", reward) for reward in priorities)
        self.free_probability = checks.real("free_probability", free_probability, 0, 1)
        count = len(self.priorities)
        table = {
            free * count + priority: {
                action: list(self._outcomes(free, priority, action)) for action in (REJECT, ACCEPT)
            }
            for free in range(self.servers + 1)
            for priority in range(count)
        }
        first = self.servers * count
        super().__init__(table, [(state >= first) / count for state in table])

    def _outcomes(self, free: int, priority: int, action: int) -> Iterator[Transition]:
        accepted = action == ACCEPT and free > 0
        reward = self.priorities[priority] if accepted else 0.0
        left = free - accepted
        busy, count = self.servers - left, len(self.priorities)
        for freed in range(busy + 1):
            share = (
                math.comb(busy, freed) * self.free_probability**freed * (1 - self.free_probability) ** (busy - freed)
            )
            for number in range(count):
                yield share / count, (left + freed) * count + number, reward, False
