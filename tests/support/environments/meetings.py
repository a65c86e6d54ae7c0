"""Environments of every kind, given in every way, with random learners: what the features of the package meet."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, get_args

import gymnasium as gym
import numpy as np
from gymnasium.wrappers import RescaleObservation, TransformReward
from hypothesis import strategies as st

from qtab.config.choices import Algorithm
from qtab.config.options import ONE_STEP, PREFERENCES, TABLES_ONLY
from support.environments import Chain, Walk
from support.environments.gridworld import Room, Tutorial
from support.environments.masked import MASKS, MaskedGraph
from support.learners.learner_settings import (
    BY_EPISODE,
    LIMITS,
    explorations,
    learning_rates,
    own_options,
    possible_explorations,
)

CAR = "MountainCar-v0"
ALGORITHMS = get_args(Algorithm)


@dataclass(frozen=True)
class Case:
    """An environment as a user gives it."""

    make: Callable[[], Any]
    """Returns an id, or a new environment."""
    kind: str
    """``"discrete"``, or for Box observations ``"box"``."""
    is_known: bool = True
    """Whether a run can make its environment again; otherwise each call needs ``env=``."""
    settings: tuple[dict[str, Any], ...] = ({},)
    """Settings that fit the environment, of which one is drawn."""

    def env(self) -> gym.Env:
        """A new environment like that of the runs, without their time limit."""
        made = self.make()
        return gym.make(made) if isinstance(made, str) else made

    def again(self) -> dict[str, Any]:
        """What a call that takes a run needs besides it."""
        return {} if self.is_known else {"env": self.make()}


def _weak_car() -> gym.Env:
    env: Any = gym.make(CAR)
    env.unwrapped.force = 0.0015
    return env


def allowed(observation: Any) -> Any:
    """The mask of an observation of :class:`MaskedGraph`."""
    return MASKS[int(observation)]


def _limited(env: gym.Env) -> gym.Env:
    return gym.wrappers.TimeLimit(env, 40)


_CAR_LIMITS = {"low": LIMITS[CAR][0], "high": LIMITS[CAR][1]}
_POLE_LIMITS = {"low": LIMITS["CartPole-v1"][0], "high": LIMITS["CartPole-v1"][1]}

CASES: dict[str, Case] = {
    "a lake": Case(lambda: "FrozenLake-v1", "discrete", settings=({}, {"env_kwargs": {"is_slippery": False}})),
    "a cliff": Case(lambda: "CliffWalking-v1", "discrete"),
    "a taxi": Case(lambda: "Taxi-v4", "discrete", settings=({}, {"action_mask": True})),
    "cards": Case(lambda: "Blackjack-v1", "discrete"),
    "a bandit": Case(lambda: "qtab/KArmedBandit-v0", "discrete"),
    "a maze of the book": Case(lambda: "qtab/DynaMaze-v0", "discrete"),
    "a car": Case(lambda: CAR, "box", settings=(_CAR_LIMITS,)),
    "a pole": Case(lambda: "CartPole-v1", "box", settings=(_POLE_LIMITS,)),
    "an object": Case(lambda: gym.make("FrozenLake-v1"), "discrete"),
    "a rescaled car": Case(lambda: RescaleObservation(gym.make(CAR), np.float32(0), np.float32(1)), "box"),
    "a weak car": Case(_weak_car, "box", settings=(_CAR_LIMITS,)),
    "another reward": Case(
        lambda: TransformReward(gym.make("FrozenLake-v1"), lambda reward: 3.0 * float(reward) - 0.25),
        "discrete",
        is_known=False,
    ),
    "nested observations": Case(partial(Room, 0.2), "discrete", is_known=False),
    "several numbers": Case(partial(Room, 0.2, multi=True), "discrete", is_known=False),
    "a Dict": Case(Tutorial, "discrete", is_known=False),
    "a walk": Case(Walk, "box", is_known=False),
    "actions from 5": Case(Chain, "box", is_known=False),
    "a short walk": Case(lambda: _limited(Walk(start=2)), "box", is_known=False),
    "masks by info": Case(
        partial(MaskedGraph, MASKS, "info"), "discrete", is_known=False, settings=({"action_mask": True},)
    ),
    "masks by a function": Case(
        partial(MaskedGraph, MASKS, "none"), "discrete", is_known=False, settings=({"action_mask": allowed},)
    ),
}


@st.composite
def meetings(draw: st.DrawFn) -> tuple[Case, dict[str, Any]]:
    """An environment, and the settings of a short run on it."""
    case = CASES[draw(st.sampled_from(sorted(CASES)))]
    algorithm = draw(st.sampled_from(ALGORITHMS))
    settings: dict[str, Any] = {**draw(st.sampled_from(case.settings))}
    if case.kind == "box":
        kinds = ["bins"] + ["tiles"] * (algorithm not in TABLES_ONLY)
        settings["discretizer"] = draw(st.sampled_from(kinds))
        if settings["discretizer"] == "tiles":
            settings |= {"tilings": draw(st.sampled_from([1, 3, 8])), "tiles": draw(st.integers(1, 3))}
        else:
            settings["bins"] = draw(st.integers(1, 4))
    elif draw(st.integers(0, 4)) == 0 and algorithm not in PREFERENCES:
        settings["time_aware"] = True
    tiles = settings.get("discretizer") == "tiles"
    if algorithm in ONE_STEP and not tiles:
        settings["terminal_update"] = draw(st.sampled_from(["assign", "target"]))
    if not settings.get("time_aware"):
        settings["on_truncation"] = draw(st.sampled_from(["bootstrap", "terminate"]))
    return case, {
        **settings,
        # Full steps of tile coding may diverge; another test covers that.
        **draw(learning_rates(0.5 if tiles else 1.0, by_visits=algorithm not in BY_EPISODE, algorithm=algorithm)),
        **draw(explorations(possible_explorations(algorithm, settings))),
        "discount": draw(st.sampled_from([0.0, 0.5, 0.9, 1.0])),
        **draw(own_options(algorithm)),
        "algorithm": algorithm,
        "count_bonus": draw(st.sampled_from([0.0, 0.0, 0.3])),
        "initial_q": draw(st.sampled_from([0.0, 1.5, (-1.0, 1.0)])),
        "bit_generator": draw(st.sampled_from(["PCG64", "MT19937"])),
        "max_episode_steps": draw(st.sampled_from([1, 4, 15])),
        "seed": draw(st.integers(0, 2**32 - 1)),
        "episodes": draw(st.integers(4, 9)),
    }
