"""The outcomes of one step of an environment, listed and repeated, and the check of its rewards."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from qtab._utils.shown import shown
from qtab.envs.tabulation.branches import Branches
from qtab.envs.tabulation.walk import Outcome


def listed(branches: Branches, take: Callable[[], Outcome]) -> tuple[list[Outcome], bool]:
    """Lists the outcomes of a step, and then repeats the first one.

    Args:
        branches: The draws of the step.
        take: A function that takes the step and returns its outcome. It is called once for each combination of draws.

    Returns:
        The outcomes with their probabilities, and whether the repeated step had the same outcome as the first one.

    Raises:
        CannotListError: if the outcomes cannot be listed.
    """
    found = [replace(outcome, probability=chance) for chance, outcome in branches.outcomes(take)]
    _, again = next(branches.outcomes(take))
    return found, again.identity == found[0].identity


def finite_reward(reward: Any, method: str, where: object) -> float:
    """Returns a reward as a float.

    Args:
        reward: What the environment returned.
        method: The method that returned it, such as ``"step of Corridor"``.
        where: The state and the action; ``str`` describes them in messages.

    Raises:
        TypeError: if the reward is not a number.
        ValueError: if it is not finite.
    """
    try:
        number = float(reward)
    except (TypeError, ValueError):
        raise TypeError(f"{method} must return a number as the reward, got {shown(reward)} {where}") from None
    if not math.isfinite(number):
        raise ValueError(f"{method} must return a finite reward, got {number} {where}")
    return number
