"""The transition tables of the exercises on dynamic programming."""

from typing import Any

import gymnasium as gym

from qtab.exercises.parts import Mistakes

Transitions = Any
"""P[state][action]: a list of (probability, next state, reward, terminated), as in Gymnasium."""


def transitions(env_id: str) -> Transitions:
    """Returns the transition table of one of Gymnasium's environments."""
    env: Any = gym.make(env_id).unwrapped
    return env.P


def action_value(P: Transitions, values: Any, state: int, action: int, discount: float, wrong: Mistakes) -> float:  # noqa: N803
    """Returns Σ p (r + γ v(s')), in which nothing follows a terminal state."""
    total = 0.0
    for probability, next_state, reward, terminated in P[state][action]:
        following = 0.0 if terminated and "terminal_value" not in wrong else float(values[next_state])
        if "no_discount" in wrong:
            target = reward + following
        elif "discounted_reward" in wrong:
            target = discount * (reward + following)
        else:
            target = reward + discount * following
        total += target if "no_probabilities" in wrong else probability * target
    return total
