"""Named settings for the environments that have a known good start."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from qtab.envs.registry import gymnasium_id

# G. Hayes, "Getting Started with Reinforcement Learning and Open AI Gym" (2019). What equals the config's default is
# not repeated: those defaults are the article's.
_ARTICLE = {"scale": (10.0, 100.0), "terminal_update": "assign"}

# Sarsa(λ) on tile coding, as in Sutton & Barto, Example 10.1 and Figure 12.10: no exploration is needed, since values
# of zero are optimistic where every step costs one.
_SOLVED = {
    "algorithm": "sarsa_lambda",
    "discretizer": "tiles",
    "tilings": 8,
    "tiles": (16,),
    "learning_rate": 0.5,
    "learning_rate_schedule": "linear",
    "discount": 1.0,
    "epsilon": 0.0,
    "trace_decay": 0.9,
    "trace_cutoff": 1e-3,
    "initial_q": 0.0,
    "episodes": 2000,
}
# Sutton & Barto, 2nd ed., Example 6.6.
_CLIFF_BOOK = {"learning_rate": 0.5, "discount": 1.0, "epsilon": 0.1, "epsilon_schedule": "constant"}
_CLIFF_BOOK |= {"initial_q": 0.0, "episodes": 500}
# Ours, tried with a few seeds: the exploration rate falls to nothing, and where chance has a part, so does the learning
# rate.
_LAKE = {"learning_rate": 0.05, "discount": 0.99, "epsilon": 1.0, "initial_q": 0.0, "episodes": 20_000}
_LARGE_LAKE = {"learning_rate": 0.2, "learning_rate_schedule": "linear", "discount": 0.999, "epsilon": 1.0}
_LARGE_LAKE |= {"initial_q": 1.0, "episodes": 20_000}
_CLIFF = {"learning_rate": 0.5, "discount": 1.0, "epsilon": 0.1, "initial_q": 0.0, "episodes": 500}
_SLIPPERY_CLIFF = {**_CLIFF, "learning_rate": 0.2, "learning_rate_schedule": "linear", "episodes": 5_000}
_TAXI = {"learning_rate": 0.5, "discount": 0.99, "epsilon": 0.1, "initial_q": 0.0, "episodes": 10_000}
_BLACKJACK = {"learning_rate": 0.02, "learning_rate_schedule": "linear", "discount": 1.0, "epsilon": 1.0}
_BLACKJACK |= {"initial_q": 0.0, "episodes": 500_000}
# Those that solve: no exploration rate, since values that begin above all that can be had explore by themselves (Sutton
# & Barto, section 2.6). Where nothing is left to chance an update may go all the way; elsewhere the learning rate falls
# to nothing. The lakes' time limits make a shorter way worth a little risk, as a discount does.
_SOLVED_LAKE = {"learning_rate": 0.1, "learning_rate_schedule": "linear", "discount": 0.99, "epsilon": 0.0}
_SOLVED_LAKE |= {"initial_q": 1.0, "episodes": 10_000}
_SOLVED_LARGE_LAKE = {**_SOLVED_LAKE, "discount": 0.997}
_SOLVED_CLIFF = {"learning_rate": 1.0, "discount": 1.0, "epsilon": 0.0, "initial_q": 0.0, "episodes": 200}
_SOLVED_SLIPPERY_CLIFF = {
    **_SOLVED_CLIFF,
    "learning_rate": 0.01,
    "learning_rate_schedule": "linear",
    "episodes": 20_000,
}
_SOLVED_TAXI = {"learning_rate": 1.0, "discount": 1.0, "epsilon": 0.0, "initial_q": 20.0, "episodes": 5_000}
# At blackjack a hand that is seldom dealt has seldom been tried: it explores to the end.
_SOLVED_BLACKJACK = {**_BLACKJACK, "learning_rate": 0.005, "episodes": 1_000_000}

# Sutton & Barto, 2nd ed., Figure 6.5. In A there are two actions, -inf standing for the others.
_BIAS_BOOK = {"learning_rate": 0.1, "discount": 1.0, "epsilon": 0.1, "epsilon_schedule": "constant", "ties": "random"}
_BIAS_BOOK |= {"initial_q": np.array([[0.0] * 2 + [-np.inf] * 8, [0.0] * 10, [0.0] * 10]), "episodes": 300}
# The speeds of cart and pole have no bounds: beyond these limits the outermost bins serve. Q-learning on a grid, from
# values that are optimistic at first (50 of at most 500) and with an exploration rate that falls to nothing.
_CART_POLE: Mapping[str, Any] = {
    "discretizer": "bins",
    "bins": (3, 3, 6, 6),
    "low": (-2.4, -2.0, -0.21, -2.0),
    "high": (2.4, 2.0, 0.21, 2.0),
    "learning_rate": 0.5,
    "learning_rate_schedule": "linear",
    "discount": 0.999,
    "epsilon": 0.2,
    "initial_q": 50.0,
    "episodes": 5000,
}
# Sarsa(λ) on tile coding again.
_TRACED: Mapping[str, Any] = {**_SOLVED, "learning_rate": 0.5, "trace_decay": 0.8, "epsilon": 0.1, "episodes": 1000}
_CART_POLE_SOLVED = {**_TRACED, "tilings": 16, "tiles": (4,), "discount": 0.999}
_CART_POLE_SOLVED |= {"low": (-2.4, -2.5, -0.21, -3.5), "high": (2.4, 2.5, 0.21, 3.5)}
_ACROBOT = {**_TRACED, "tilings": 32, "tiles": (4, 4, 4, 4, 5, 5), "discount": 0.99, "epsilon": 0.0}
_ACROBOT |= {"learning_rate_schedule": "constant"}
_PENDULUM = {**_TRACED, "actions": 3, "tilings": 16, "tiles": (6,), "discount": 0.98}
# Pushing costs: only first values of 100 (12.5 a tiling) keep the car from learning to stand still.
_CONTINUOUS_CAR = {**_TRACED, "actions": (-0.3, 0.3), "learning_rate": 0.2, "trace_decay": 0.9}
_CONTINUOUS_CAR |= {"initial_q": 12.5, "episodes": 500}

# The first preset of an environment is its own.
_PRESETS: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "MountainCar-v0": {"article": _ARTICLE, "solved": _SOLVED},
    "MountainCarContinuous-v0": {"solved": _CONTINUOUS_CAR},
    "CartPole-v0": {"tuned": _CART_POLE, "solved": _CART_POLE_SOLVED},
    "CartPole-v1": {"tuned": _CART_POLE, "solved": _CART_POLE_SOLVED},
    "Acrobot-v1": {"solved": _ACROBOT},
    "Pendulum-v1": {"tuned": _PENDULUM},
    "FrozenLake-v1": {"tuned": _LAKE, "solved": _SOLVED_LAKE},
    "FrozenLake8x8-v1": {"tuned": _LARGE_LAKE, "solved": _SOLVED_LARGE_LAKE},
    "CliffWalking-v1": {"tuned": _CLIFF, "book": _CLIFF_BOOK, "solved": _SOLVED_CLIFF},
    "CliffWalkingSlippery-v1": {"tuned": _SLIPPERY_CLIFF, "solved": _SOLVED_SLIPPERY_CLIFF},
    "Taxi-v4": {"tuned": _TAXI, "solved": _SOLVED_TAXI},
    "Blackjack-v1": {"tuned": _BLACKJACK, "solved": _SOLVED_BLACKJACK},
    "MaximizationBias-v0": {"book": _BIAS_BOOK},
}


def presets(env: str) -> Mapping[str, Mapping[str, Any]]:
    """Returns the presets of an environment by name, its own one first."""
    return MappingProxyType(_PRESETS.get(gymnasium_id(env), {}))


def preset(env: str, name: str | None) -> tuple[str | None, Mapping[str, Any]]:
    """Returns the name and the values of an environment's preset; None asks for its own, if it has one.

    Raises:
        ValueError: if there is none of that name.
    """
    known = presets(env)
    if name is None:
        return next(iter(known.items()), (None, {}))
    if name not in known:
        there = ", ".join(map(repr, known)) or "none"
        raise ValueError(f"preset must be one that {env} has ({there}), got {name!r}")
    return name, known[name]
