"""Two environments in lock-step: ours and Gymnasium's, equal to the last bit, in type, in warning and in error."""

import copy
import warnings
from typing import Any

import gymnasium as gym

from support.exact import bitwise
from support.processes.machine import MACHINE


def outcome(call: Any, env: Any) -> Any:
    """What a call on an environment returns or raises, and what it warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            value = bitwise(call(env))
        except Exception as error:
            value = type(error), str(error)
    return value, [(warning.category, str(warning.message)) for warning in caught]


class Lockstep:
    """Our environment beside Gymnasium's: what is done to one is done to both, and the results must be equal."""

    def __init__(self, name: str, **kwargs: Any) -> None:
        self.name = name
        self.ours: Any = gym.make(f"qtab/{name}", **kwargs).unwrapped
        self.theirs: Any = gym.make(name, **kwargs).unwrapped
        assert type(self.ours).__module__.startswith("qtab.")

    def both(self, call: Any) -> Any:
        """Calls a function with each of the two and returns the outcome, which must be the same."""
        ours, theirs = outcome(call, self.ours), outcome(call, self.theirs)
        assert ours == theirs, (self.name, MACHINE)
        return ours

    def set(self, **attributes: Any) -> None:
        for name, value in attributes.items():
            for env in (self.ours, self.theirs):
                setattr(env, name, copy.deepcopy(value))

    def reset(self, **kwargs: Any) -> Any:
        return self.both(lambda env: env.reset(**kwargs))
