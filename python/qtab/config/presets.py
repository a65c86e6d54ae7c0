"""Named settings for environments: the article's, the textbook's, and ones that learn well."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils.shown import shown
from qtab._utils.suggestions import did_you_mean
from qtab.config.settings import SharedSettings
from qtab.envs.registry import gymnasium_id, spec_of

# G. Hayes, "Getting Started with Reinforcement Learning and Open AI Gym" (2019). The article's other settings are the
# config's defaults.
_ARTICLE: SharedSettings = {"scale": (10.0, 100.0), "terminal_update": "assign"}

# Sutton & Barto, 2nd ed., Example 6.6.
_CLIFF_BOOK: SharedSettings = {
    "learning_rate": 0.5,
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "initial_q": 0.0,
    "episodes": 500,
}

# Sutton & Barto, 2nd ed., Figure 6.5. State A has two actions; -inf stands for the others.
_BIAS_BOOK: SharedSettings = {
    "learning_rate": 0.1,
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": np.array([[0.0] * 2 + [-np.inf] * 8, [0.0] * 10, [0.0] * 10]),
    "episodes": 300,
}

# Sutton & Barto, 2nd ed., Figure 2.2: sample averages and an exploration rate of 0.1.
_BANDIT_BOOK: SharedSettings = {
    "learning_rate": 1.0,
    "learning_rate_schedule": "visits",
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    "episodes": 1000,
}

# Sutton & Barto, 2nd ed., Figure 13.1. The first policy goes right with probability 0.05, as the figure's first returns
# show; the book does not state it.
_CORRIDOR_BOOK: SharedSettings = {
    "algorithm": "reinforce",
    "learning_rate": 2.0**-13,
    "discount": 1.0,
    "initial_q": np.array([[math.log(19.0), 0.0]]),
    "episodes": 1000,
}

# Tuned by hand over a few seeds. The exploration rate falls to 0, and in environments with chance so does the learning
# rate.
_LAKE: SharedSettings = {
    "learning_rate": 0.05,
    "discount": 0.99,
    "epsilon": 1.0,
    "initial_q": 0.0,
    "episodes": 20_000,
}
_LARGE_LAKE: SharedSettings = {
    "learning_rate": 0.2,
    "learning_rate_schedule": "linear",
    "discount": 0.999,
    "epsilon": 1.0,
    "initial_q": 1.0,
    "episodes": 20_000,
}
_CLIFF: SharedSettings = {
    "learning_rate": 0.5,
    "discount": 1.0,
    "epsilon": 0.1,
    "initial_q": 0.0,
    "episodes": 500,
}
_SLIPPERY_CLIFF: SharedSettings = {
    **_CLIFF,
    "learning_rate": 0.2,
    "learning_rate_schedule": "linear",
    "episodes": 5_000,
}
_TAXI: SharedSettings = {
    "learning_rate": 0.5,
    "discount": 0.99,
    "epsilon": 0.1,
    "initial_q": 0.0,
    "episodes": 10_000,
}
_BLACKJACK: SharedSettings = {
    "learning_rate": 0.02,
    "learning_rate_schedule": "linear",
    "discount": 1.0,
    "epsilon": 1.0,
    "initial_q": 0.0,
    "episodes": 500_000,
}
# The velocities of cart and pole have no bounds: what lies outside these limits falls into the outermost bins. The
# initial values are optimistic at first (50, where a return is at most 500).
_CART_POLE: SharedSettings = {
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

# These find an optimal policy. With optimistic initial values they need no exploration rate (Sutton & Barto, section
# 2.6). In deterministic environments the learning rate can be 1; in the others it falls to 0. On the lakes the time
# limit makes a shorter path worth a little risk, and so does a discount.
_SOLVED_LAKE: SharedSettings = {
    "learning_rate": 0.1,
    "learning_rate_schedule": "linear",
    "discount": 0.99,
    "epsilon": 0.0,
    "initial_q": 1.0,
    "episodes": 10_000,
}
_SOLVED_LARGE_LAKE: SharedSettings = {**_SOLVED_LAKE, "discount": 0.997}
# These count the steps, as the optimum under the time limit does. Optimistic values let every state be tried at every
# step, and a little chance goes on trying. Chosen on the seeds 20,000 to 20,003.
_TIME_AWARE_LAKE: SharedSettings = {
    "time_aware": True,
    "learning_rate": 0.2,
    "learning_rate_schedule": "linear",
    "discount": 1.0,
    "epsilon": 0.05,
    "epsilon_schedule": "constant",
    "initial_q": 1.0,
    "episodes": 300_000,
}
_TIME_AWARE_LARGE_LAKE: SharedSettings = {**_TIME_AWARE_LAKE, "learning_rate": 0.3, "episodes": 2_000_000}
_SOLVED_CLIFF: SharedSettings = {
    "learning_rate": 1.0,
    "discount": 1.0,
    "epsilon": 0.0,
    "initial_q": 0.0,
    "episodes": 200,
}
_SOLVED_SLIPPERY_CLIFF: SharedSettings = {
    **_SOLVED_CLIFF,
    "learning_rate": 0.01,
    "learning_rate_schedule": "linear",
    "episodes": 20_000,
}
_SOLVED_TAXI: SharedSettings = {
    "learning_rate": 1.0,
    "discount": 1.0,
    "epsilon": 0.0,
    "initial_q": 20.0,
    "episodes": 5_000,
}
# Some hands of blackjack are rarely dealt, and have rarely been tried: this explores to the end.
_SOLVED_BLACKJACK: SharedSettings = {**_BLACKJACK, "learning_rate": 0.005, "episodes": 1_000_000}

# Sarsa(λ) on tile coding, as in Sutton & Barto, Example 10.1 and Figure 12.10. It needs no exploration rate: values of
# 0 are optimistic where every step costs 1.
_TILES: SharedSettings = {
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
# Chosen on the seeds 20,000 to 20,199; docs/reference/environments.md reports others.
_SOLVED_MOUNTAIN_CAR: SharedSettings = {
    **_TILES,
    "algorithm": "true_online_sarsa_lambda",
    "tilings": 32,
    "tiles": (8,),
    "learning_rate": 1.5,
    "trace_decay": 0.85,
    "episodes": 1000,
}
# Pushing costs energy: with initial values below 100 (12.5 in each tiling) the car learns to stand still.
_CONTINUOUS_MOUNTAIN_CAR: SharedSettings = {
    **_TILES,
    "actions": (-0.3, 0.3),
    "learning_rate": 0.2,
    "epsilon": 0.1,
    "initial_q": 12.5,
    "episodes": 500,
}
_TRACES: SharedSettings = {**_TILES, "trace_decay": 0.8, "epsilon": 0.1, "episodes": 1000}
_SOLVED_CART_POLE: SharedSettings = {
    **_TRACES,
    "tilings": 16,
    "tiles": (4,),
    "low": (-2.4, -2.5, -0.21, -3.5),
    "high": (2.4, 2.5, 0.21, 3.5),
    "discount": 0.999,
}
_ACROBOT: SharedSettings = {
    **_TRACES,
    "tilings": 32,
    "tiles": (4, 4, 4, 4, 5, 5),
    "learning_rate_schedule": "constant",
    "discount": 0.99,
    "epsilon": 0.0,
}
_PENDULUM: SharedSettings = {**_TRACES, "actions": 3, "tilings": 16, "tiles": (6,), "discount": 0.98}

# An environment's first preset is its default.
_PRESETS: Mapping[str, Mapping[str, SharedSettings]] = {
    "MountainCar-v0": {"article": _ARTICLE, "solved": _SOLVED_MOUNTAIN_CAR},
    "MountainCarContinuous-v0": {"solved": _CONTINUOUS_MOUNTAIN_CAR},
    "CartPole-v0": {"tuned": _CART_POLE, "solved": _SOLVED_CART_POLE},
    "CartPole-v1": {"tuned": _CART_POLE, "solved": _SOLVED_CART_POLE},
    "Acrobot-v1": {"solved": _ACROBOT},
    "Pendulum-v1": {"tuned": _PENDULUM},
    "FrozenLake-v1": {"tuned": _LAKE, "solved": _SOLVED_LAKE, "time_aware": _TIME_AWARE_LAKE},
    "FrozenLake8x8-v1": {
        "tuned": _LARGE_LAKE,
        "solved": _SOLVED_LARGE_LAKE,
        "time_aware": _TIME_AWARE_LARGE_LAKE,
    },
    "CliffWalking-v1": {"tuned": _CLIFF, "book": _CLIFF_BOOK, "solved": _SOLVED_CLIFF},
    "CliffWalkingSlippery-v1": {"tuned": _SLIPPERY_CLIFF, "solved": _SOLVED_SLIPPERY_CLIFF},
    "Taxi-v4": {"tuned": _TAXI, "solved": _SOLVED_TAXI},
    "Blackjack-v1": {"tuned": _BLACKJACK, "solved": _SOLVED_BLACKJACK},
    "KArmedBandit-v0": {"book": _BANDIT_BOOK},
    "MaximizationBias-v0": {"book": _BIAS_BOOK},
    "ShortCorridor-v0": {"book": _CORRIDOR_BOOK},
}


def presets(env: str) -> Mapping[str, SharedSettings]:
    """Returns the presets of an environment by name, the default one first; none for one that has no presets.

    Args:
        env: The environment's id in Gymnasium.

    Raises:
        TypeError: if ``env`` is not a string.
        ValueError: if it is not a registered id; the message suggests the nearest one that has presets.
    """
    if not isinstance(env, str):
        raise TypeError(f"env must be an environment id, got {shown(env)}")
    known = _presets(env)
    if not known:
        try:
            known = _presets(spec_of(env).id)
        except (gym.error.Error, ModuleNotFoundError):
            suggestion = did_you_mean(env, _PRESETS)
            raise ValueError(f"env must be a registered environment id, got {shown(env)}{suggestion}") from None
    return MappingProxyType(known)


def _presets(env: str) -> Mapping[str, SharedSettings]:
    return _PRESETS.get(gymnasium_id(env), {})


def preset(env: str, name: str | None) -> tuple[str | None, Mapping[str, Any]]:
    """Returns the name and the values of an environment's preset; None asks for the first one, if it has any.

    Raises:
        ValueError: if it has none of that name.
    """
    known = _presets(env)
    if name is None:
        return next(iter(known.items())) if known else (None, {})
    if name not in known:
        if not known:
            raise ValueError(f"preset must be left out for {env}, which has none, got {shown(name)}")
        names = ", ".join(map(repr, known))
        raise ValueError(f"preset must be one of {names} for {env}, got {shown(name)}{did_you_mean(name, known)}")
    return name, known[name]
