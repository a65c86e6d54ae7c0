"""Toy text in lock-step with Gymnasium's."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from support.exact import identical
from support.lockstep import Lockstep

IDS = [
    "FrozenLake-v1",
    "FrozenLake8x8-v1",
    "CliffWalking-v1",
    "CliffWalkingSlippery-v1",
    "Taxi-v4",
    "Blackjack-v1",
]
TABLES = IDS[:-1]
"""The environments that have a transition table."""
ATTRIBUTES = [
    *("s", "lastaction", "fickle_step", "taxi_orientation"),
    *("player", "dealer", "dealer_top_card_suit", "dealer_top_card_value_str"),
]
"""The state that the environments keep between steps."""


ABSENT = object()


class LockstepToyText(Lockstep):
    """An environment of toy text beside Gymnasium's."""

    def both(self, call: Any) -> Any:
        found = super().both(call)
        self.assert_same_state()
        return found

    def assert_same_state(self) -> None:
        """Asserts that attributes and generators are the same."""
        for name in ATTRIBUTES:
            ours, theirs = getattr(self.ours, name, ABSENT), getattr(self.theirs, name, ABSENT)
            assert identical(ours, theirs), (name, ours, theirs)
        generators = self.ours.np_random.bit_generator, self.theirs.np_random.bit_generator
        assert generators[0].state == generators[1].state

    def run(self, steps: int, policy: Sequence[int] | None = None, seed: int = 0) -> int:
        """Takes so many steps, episode by episode, and returns how many episodes terminated.

        Actions are random; with a policy, an action for each state, three in four are the policy's.
        """
        self.reset(seed=seed)
        episodes = 0
        for step, action in enumerate(np.random.default_rng(seed).integers(self.theirs.action_space.n, size=steps)):
            chosen = int(action) if policy is None or step % 4 == 0 else policy[self.theirs.s]
            ours, theirs = self.ours.step(chosen), self.theirs.step(chosen)
            assert identical(ours, theirs), (self.name, step, ours, theirs)
            if step % 97 == 0:
                self.assert_same_state()
            if theirs[2] or step % 300 == 299:
                episodes += bool(theirs[2])
                ours, theirs = self.ours.reset(), self.theirs.reset()
                assert identical(ours, theirs), (self.name, step, ours, theirs)
        self.assert_same_state()
        return episodes
