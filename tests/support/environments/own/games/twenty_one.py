"""Blackjack with an infinite deck and simple rules."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


def drawn_card(rng: np.random.Generator) -> int:
    return min(int(rng.integers(1, 14)), 10)


class TwentyOne(qtab.FunctionalEnv):
    """The state is the player's sum, the dealer's card and whether the player has a usable ace."""

    observation_space = gym.spaces.Tuple((gym.spaces.Discrete(32), gym.spaces.Discrete(11), gym.spaces.Discrete(2)))
    action_space = gym.spaces.Discrete(2)

    def initial_state(self, rng: np.random.Generator) -> Any:
        first, second = drawn_card(rng), drawn_card(rng)
        ace = first == 1 or second == 1
        return first + second + (10 if ace else 0), drawn_card(rng), ace

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        total, dealer, ace = state
        if action == 1:
            total += drawn_card(rng)
            if total > 21 and ace:
                total, ace = total - 10, False
            if total > 21:
                return (total, dealer, ace), -1.0, True
            return (total, dealer, ace), 0.0, False
        against = dealer
        while against < 17:
            against += drawn_card(rng)
        if against > 21 or total > against:
            return (total, dealer, ace), 1.0, True
        return (total, dealer, ace), 0.0 if total == against else -1.0, True

    def observe(self, state: Any) -> Any:
        return state
