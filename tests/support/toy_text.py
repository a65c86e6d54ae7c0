"""Toy text in lock-step: ours beside Gymnasium's, what is done to one is done to both, and must come out equal."""

import copy
from typing import Any

import gymnasium as gym
import numpy as np

from support.lockstep import frozen, outcome

IDS = [
    "FrozenLake-v1",
    "FrozenLake8x8-v1",
    "CliffWalking-v1",
    "CliffWalkingSlippery-v1",
    "Taxi-v4",
    "Blackjack-v1",
]
TABLES = IDS[:-1]
KEPT = ["s", "lastaction", "fickle_step", "taxi_orientation", "player", "dealer", "dealer_top_card_suit"]
KEPT += ["dealer_top_card_value_str"]


def flat(value: Any) -> Any:
    """What can be compared of what a reset or a step returns, its info included."""
    if isinstance(value, tuple):
        return tuple(map(flat, value))
    if isinstance(value, list):
        return [flat(item) for item in value]
    if isinstance(value, dict):
        return {name: flat(item) for name, item in value.items()}
    return frozen(value)


class LockstepToyText:
    """An environment of ours beside Gymnasium's."""

    def __init__(self, name: str, **kwargs: Any) -> None:
        self.ours = gym.make(f"qtab/{name}", **kwargs).unwrapped
        self.theirs = gym.make(name, **kwargs).unwrapped
        assert type(self.ours).__module__.startswith("qtab.")

    def both(self, call: Any) -> Any:
        def flattened(env: Any) -> Any:
            return flat(call(env))

        ours, theirs = outcome(flattened, self.ours), outcome(flattened, self.theirs)
        assert ours == theirs
        self.same()
        return ours

    def set(self, **attributes: Any) -> None:
        for name, value in attributes.items():
            for env in (self.ours, self.theirs):
                setattr(env, name, copy.deepcopy(value))

    def same(self) -> None:
        """Attributes and generators stand alike."""
        for name in KEPT:
            assert hasattr(self.ours, name) == hasattr(self.theirs, name), name
            if hasattr(self.ours, name):
                assert flat(getattr(self.ours, name)) == flat(getattr(self.theirs, name)), name
        generators = self.ours.np_random.bit_generator, self.theirs.np_random.bit_generator
        assert generators[0].state == generators[1].state

    def run(self, steps: int, policy: Any = None, seed: int = 0) -> int:
        """Takes so many steps, episode by episode, and returns how many ended."""
        self.both(lambda env: env.reset(seed=seed))
        rng, episodes = np.random.default_rng(seed), 0
        mask = None
        for step in range(steps):
            action = int(rng.integers(self.theirs.action_space.n))
            if mask is not None and step % 3:  # a driver who gets somewhere
                action = int(rng.choice(np.flatnonzero(mask)))
            ours, theirs = self.ours.step(action), self.theirs.step(action)
            assert flat(ours) == flat(theirs), (step, ours, theirs)
            mask = theirs[4].get("action_mask")
            if step % 97 == 0:
                self.same()
            if theirs[2] or step % 300 == 299:
                episodes += bool(theirs[2])
                ours, theirs = self.ours.reset(), self.theirs.reset()
                assert flat(ours) == flat(theirs), (step, ours, theirs)
        self.same()
        return episodes
