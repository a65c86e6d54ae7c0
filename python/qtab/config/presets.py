"""Named settings for environments: the article's, the textbook's, and ones that learn well."""

from collections.abc import Mapping
from copy import deepcopy
from types import MappingProxyType
from typing import Any

import gymnasium as gym

from qtab._utils.shown import did_you_mean, shown
from qtab.config import preset_settings
from qtab.config.settings import SharedSettings
from qtab.envs.registry import gymnasium_id, spec_of

# G. Hayes, "Getting Started with Reinforcement Learning and Open AI Gym" (2019). The article's other settings are the
# config's defaults.
_ARTICLE: SharedSettings = {"scale": (10.0, 100.0), "terminal_update": "assign"}

# Tuned by hand on a few seeds. The exploration rate falls to 0, and in stochastic environments so does the learning
# rate.
_LAKE: SharedSettings = {
    "learning_rate": 0.05,
    "discount": 0.99,
    "epsilon": 1.0,
    "epsilon_schedule": "linear",
    "initial_q": 0.0,
    "episodes": 20_000,
}
_LARGE_LAKE: SharedSettings = {
    "learning_rate": 0.2,
    "learning_rate_schedule": "linear",
    "discount": 0.999,
    "epsilon": 1.0,
    "epsilon_schedule": "linear",
    "initial_q": 1.0,
    "episodes": 20_000,
}
_CLIFF: SharedSettings = {
    "learning_rate": 0.5,
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "linear",
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
    "epsilon_schedule": "linear",
    "initial_q": 0.0,
    "episodes": 10_000,
}
_BLACKJACK: SharedSettings = {
    "learning_rate": 0.02,
    "learning_rate_schedule": "linear",
    "discount": 1.0,
    "epsilon": 1.0,
    "epsilon_schedule": "linear",
    "initial_q": 0.0,
    "episodes": 500_000,
}
# The velocities of cart and pole are unbounded: values outside these limits fall into the outermost bins. The initial
# values are optimistic at first (50, while a return is at most 500).
_CART_POLE: SharedSettings = {
    "discretizer": "bins",
    "bins": (3, 3, 6, 6),
    "low": (-2.4, -2.0, -0.21, -2.0),
    "high": (2.4, 2.0, 0.21, 2.0),
    "learning_rate": 0.5,
    "learning_rate_schedule": "linear",
    "discount": 0.999,
    "epsilon": 0.2,
    "epsilon_schedule": "linear",
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
_SOLVED_LARGE_LAKE: SharedSettings = {
    **_SOLVED_LAKE,
    "learning_rate": 0.05,
    "discount": 0.996,
    "episodes": 100_000,
}
# These include the number of steps in the state, as the optimum under the time limit does. Optimistic values make the
# agent try every state at every step, and a small exploration rate keeps trying. Chosen on the seeds 20,000 to 20,003.
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
    "episodes": 10_000,
}
# Planning with the counted outcomes brings the policy within 3 % of the optimum, which is -11.69.
_SOLVED_RACETRACK: SharedSettings = {
    "algorithm": "dyna_q",
    "model": "stochastic",
    "planning_steps": 5,
    "learning_rate": 1.0,
    "learning_rate_schedule": "linear",
    "discount": 1.0,
    "epsilon": 0.0,
    "initial_q": 0.0,
    "episodes": 20_000,
}
# Some hands of blackjack are rarely dealt, and so rarely tried: this explores to the end.
_SOLVED_BLACKJACK: SharedSettings = {**_BLACKJACK, "learning_rate": 0.005, "episodes": 1_000_000}

# An environment's first preset is its default.
_PRESETS: Mapping[str, Mapping[str, SharedSettings]] = {
    "MountainCar-v0": {"article": _ARTICLE, "solved": preset_settings.SOLVED_MOUNTAIN_CAR},
    "MountainCarContinuous-v0": {"solved": preset_settings.CONTINUOUS_MOUNTAIN_CAR},
    "CartPole-v0": {"tuned": _CART_POLE, "solved": preset_settings.SOLVED_CART_POLE},
    "CartPole-v1": {"tuned": _CART_POLE, "solved": preset_settings.SOLVED_CART_POLE},
    "Acrobot-v1": {"solved": preset_settings.ACROBOT},
    "Pendulum-v1": {"tuned": preset_settings.PENDULUM},
    "LunarLander-v3": {"solved": preset_settings.LUNAR_LANDER},
    "FrozenLake-v1": {"tuned": _LAKE, "solved": _SOLVED_LAKE, "time_aware": _TIME_AWARE_LAKE},
    "FrozenLake8x8-v1": {
        "tuned": _LARGE_LAKE,
        "solved": _SOLVED_LARGE_LAKE,
        "time_aware": _TIME_AWARE_LARGE_LAKE,
    },
    "CliffWalking-v1": {"tuned": _CLIFF, "book": preset_settings.CLIFF_WALKING, "solved": _SOLVED_CLIFF},
    "CliffWalkingSlippery-v1": {"tuned": _SLIPPERY_CLIFF, "solved": _SOLVED_SLIPPERY_CLIFF},
    "Taxi-v4": {"tuned": _TAXI, "solved": _SOLVED_TAXI},
    "Blackjack-v1": {"tuned": _BLACKJACK, "solved": _SOLVED_BLACKJACK},
    "KArmedBandit-v0": {"book": preset_settings.K_ARMED_BANDIT},
    "MaximizationBias-v0": {"book": preset_settings.MAXIMIZATION_BIAS},
    "AccessControlQueue-v0": {"book": preset_settings.ACCESS_CONTROL_QUEUE},
    "BlockingMaze-v0": {"book": preset_settings.BLOCKING_MAZE},
    "DynaMaze-v0": {"book": preset_settings.DYNA_MAZE},
    "Racetrack-v0": {"solved": _SOLVED_RACETRACK},
    "ShortcutMaze-v0": {"book": preset_settings.SHORTCUT_MAZE},
    "ShortCorridor-v0": {"book": preset_settings.SHORT_CORRIDOR},
}


def presets(env: str) -> Mapping[str, SharedSettings]:
    """Returns the presets of an environment by name, the default one first; empty if it has no presets.

    The settings of each preset are a copy: changing them does not change the preset.

    Args:
        env: The environment's id in Gymnasium.

    Raises:
        TypeError: if ``env`` is not a string.
        ValueError: if it is not a registered id; the message suggests the nearest one that has presets.
    """
    if not isinstance(env, str):
        raise TypeError(f"env must be an environment id, got {shown(env)}")
    known = _PRESETS.get(gymnasium_id(env), {})
    if not known:
        try:
            known = _PRESETS.get(gymnasium_id(spec_of(env).id), {})
        except (gym.error.Error, ModuleNotFoundError):
            suggestion = did_you_mean(env, _PRESETS)
            raise ValueError(f"env must be a registered environment id, got {shown(env)}{suggestion}") from None
    return MappingProxyType(deepcopy(dict(known)))


def preset(env: str, name: str | None) -> tuple[str | None, Mapping[str, Any]]:
    """Returns the name and the values of an environment's preset; None selects the first one, if there is any.

    Raises:
        ValueError: if there is none of that name.
    """
    known = _PRESETS.get(gymnasium_id(env), {})
    if name is None:
        return next(iter(known.items())) if known else (None, {})
    if name not in known:
        if not known:
            raise ValueError(f"preset must be left out for {env}, which has none, got {shown(name)}")
        names = ", ".join(map(repr, known))
        raise ValueError(f"preset must be one of {names} for {env}, got {shown(name)}{did_you_mean(name, known)}")
    return name, known[name]
