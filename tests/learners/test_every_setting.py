"""Every setting of every algorithm: it changes what is learned, or it is refused by name, and never ignored."""

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, get_args

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.config.choices import Algorithm
from qtab.config.options import FIXED, PREFERENCES
from qtab.envs.book.random_mdp import random_mdp

CAR = "MountainCarContinuous-v0"


def mdp() -> gym.Env:
    """States that are visited again, rewards of both signs, chance, and episodes that end in both ways."""
    return random_mdp(6, 2, actions=3, termination=0.1)


@dataclass(frozen=True)
class Pair:
    """Two values of a setting, and what two runs that differ in nothing else have in common."""

    values: tuple[Any, Any]
    common: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    env: Callable[[], Any] = mdp


def falling(name: str, schedule: str, values: tuple[Any, Any]) -> Pair:
    return Pair(values, {f"{name}_schedule": schedule, name: 0.5})


def on_the_car(values: tuple[Any, Any], **common: Any) -> Pair:
    return Pair(values, {"actions": 3, **common}, lambda: CAR)


def cell(observation: Any) -> int:
    return int(10.0 * observation[0]) % 7


PAIRS: dict[str, Pair] = {
    "env_kwargs": Pair(({"mean": 0.0}, {"mean": 4.0}), env=lambda: "qtab/KArmedBandit-v0"),
    "max_episode_steps": Pair((12, 3)),
    "time_aware": Pair((False, True)),
    "episodes": Pair((20, 21)),
    "seed": Pair((0, 1)),
    "bit_generator": Pair(("PCG64", "MT19937")),
    "preset": Pair(("tuned", "solved"), env=lambda: "FrozenLake-v1"),
    "learning_rate": Pair((0.5, 0.25)),
    "discount": Pair((0.9, 0.5)),
    "learning_rate_schedule": Pair(("constant", "linear")),
    "min_learning_rate": falling("learning_rate", "linear", (0.0, 0.25)),
    "learning_rate_decay": falling("learning_rate", "exponential", (0.9, 0.5)),
    "learning_rate_warm_up": falling("learning_rate", "linear", (0, 10)),
    "trace_decay": Pair((0.9, 0.5)),
    "traces": Pair(("replacing", "accumulating")),
    "trace_cutoff": Pair((0.0, 0.5)),
    "n_steps": Pair((4, 2)),
    "sigma": Pair((0.25, 0.75)),
    "target_policy": Pair(("greedy", "behavior")),
    "planning_steps": Pair((10, 2)),
    "time_weight": Pair((0.0, 1.0)),
    "model": Pair(("deterministic", "stochastic")),
    "priority_threshold": Pair((0.0, 2.0)),
    "reward_learning_rate": Pair((0.01, 0.5)),
    "baseline": Pair((True, False)),
    "value_learning_rate": Pair((0.1, 0.5)),
    "initial_q": Pair((0.0, 1.0)),
    "terminal_update": Pair(("target", "assign")),
    "on_truncation": Pair(("bootstrap", "terminate")),
    "exploration": Pair(("epsilon_greedy", "softmax")),
    "epsilon": Pair((0.8, 0.2)),
    "epsilon_schedule": Pair(("linear", "exponential"), {"epsilon": 0.5}),
    "min_epsilon": falling("epsilon", "linear", (0.0, 0.25)),
    "epsilon_decay": falling("epsilon", "exponential", (0.9, 0.5)),
    "epsilon_warm_up": falling("epsilon", "linear", (0, 10)),
    "ties": Pair(("first", "random"), {"initial_q": 0.0, "epsilon": 0.3}),
    "temperature": Pair((1.0, 0.1), {"exploration": "softmax"}),
    "confidence": Pair((0.1, 4.0), {"exploration": "ucb"}),
    "count_bonus": Pair((0.0, 1.0)),
    "action_mask": Pair((False, lambda state: np.arange(3) != state % 3)),
    "discretizer": on_the_car(("round", "bins"), scale=()),
    "shape": on_the_car(((7,), (14,)), discretizer=cell),
    "max_rows": on_the_car((None, 500), discretizer="bins"),
    "scale": on_the_car(((10, 100), (5, 100)), discretizer="round"),
    "tilings": on_the_car((8, 4), discretizer="tiles"),
    "tiles": on_the_car((8, 4), discretizer="tiles"),
    "hashed_rows": on_the_car((None, 50), discretizer="tiles"),
    "bins": on_the_car((10, 5), discretizer="bins"),
    "edges": on_the_car((((-0.5,), (0.0,)), ((-0.6,), (0.0,))), discretizer="edges"),
    "order": on_the_car((3, 2), discretizer="fourier"),
    "coupled": on_the_car((True, False), discretizer="fourier"),
    "scale_step_sizes": on_the_car((True, False), discretizer="fourier"),
    "centers": on_the_car((5, 4), discretizer="radial"),
    "width": on_the_car((1.0, 0.5), discretizer="radial"),
    "normalized": on_the_car((True, False), discretizer="radial"),
    "radius": on_the_car((1.5, 1.0), discretizer="coarse"),
    "low": on_the_car(((-1.2, -0.07), (-0.6, -0.07)), discretizer="bins"),
    "high": on_the_car(((0.6, 0.07), (-0.4, 0.07)), discretizer="bins"),
    "actions": on_the_car((2, (-1.0, 1.0, 0.0)), discretizer="bins"),
}
NEUTRAL = {
    "env": "every pair of values has an environment",
    "algorithm": "every test has one",
    "backend": "Rust and Python give the same tables, as the tests of backends show",
}


def test_every_setting_has_two_values_here_or_a_reason_why_not() -> None:
    assert [field.name for field in dataclasses.fields(qtab.Config)] == sorted(
        PAIRS.keys() | NEUTRAL.keys(), key=[field.name for field in dataclasses.fields(qtab.Config)].index
    )


def is_refused(algorithm: str, name: str, pair: Pair) -> bool:
    """Trains with both values; returns whether one is refused by name. Fails where both give the same table."""
    given = {"algorithm": algorithm, "episodes": 20, "max_episode_steps": 12, "seed": 0, **pair.common}
    tables = []
    for value in pair.values:
        try:
            tables.append(qtab.train(pair.env(), **{**given, name: value}, progress=False).tables)
        except ValueError as error:
            if str(error).split(" ", 1)[0] not in (name, "algorithm", *pair.common):
                raise
            return True
    assert tables[0].tobytes() != tables[1].tobytes(), f"{name} is ignored"
    return False


@pytest.mark.parametrize("algorithm", get_args(Algorithm))
def test_a_setting_changes_what_is_learned_or_is_refused(algorithm: str) -> None:
    refused = {name for name, pair in PAIRS.items() if is_refused(algorithm, name, pair)}
    fixed = set(FIXED[algorithm].values) if algorithm in FIXED else set()
    assert fixed <= refused
    assert "learning_rate" not in refused


@pytest.mark.parametrize(
    ("algorithm", "name", "value", "message"),
    [
        ("gradient_bandit", "discount", 0.9, r"0 for .* 'gradient_bandit', which learns from the next reward alone"),
        (
            "gradient_bandit",
            "on_truncation",
            "bootstrap",
            "'terminate' for .*, which learns from the next reward alone",
        ),
        ("reinforce", "on_truncation", "bootstrap", "'terminate' for .*, which learns from the rewards of an episode"),
        ("reinforce_with_baseline", "on_truncation", "bootstrap", "'terminate' for .*, which learns from the rewards"),
    ],
)
def test_a_setting_that_has_one_value_is_refused_by_name(algorithm: Any, name: str, value: Any, message: str) -> None:
    given: dict[str, Any] = {name: value}
    with pytest.raises(ValueError, match=rf"^{name} must be {message}.*, got {value!r}$"):
        qtab.train("FrozenLake-v1", algorithm=algorithm, **given)
    with pytest.raises(ValueError, match=rf"^{name} must be {message}.*, got {value!r}$"):
        qtab.Config(algorithm=algorithm, **given)


@pytest.mark.parametrize("algorithm", FIXED)
def test_an_algorithm_brings_its_only_value_and_takes_it_away_again(algorithm: Any) -> None:
    fixed, usual = FIXED[algorithm].values, qtab.Config()
    exploration: Any = "softmax" if algorithm in PREFERENCES else "epsilon_greedy"
    complete = qtab.train("FrozenLake-v1", algorithm=algorithm, episodes=1).config
    for config in (
        complete,
        qtab.Config(algorithm=algorithm),
        usual.replace(algorithm=algorithm, exploration=exploration),
        qtab.train("FrozenLake-v1", config=usual, algorithm=algorithm, exploration=exploration, episodes=1).config,
    ):
        assert {name: getattr(config, name) for name in fixed} == fixed
        assert config.replace(seed=3).discount == config.discount
    back = qtab.Config(algorithm=algorithm).replace(algorithm="sarsa", exploration="epsilon_greedy")
    trained = qtab.train(
        "FrozenLake-v1", config=complete, algorithm="sarsa", exploration=exploration, episodes=1
    ).config
    fresh = qtab.train("FrozenLake-v1", algorithm="sarsa", episodes=1).config
    for name in fixed:
        assert getattr(back, name) == getattr(usual, name)
        assert getattr(trained, name) == getattr(fresh, name)


def test_a_time_aware_run_keeps_what_its_time_limit_needs() -> None:
    config = qtab.train("FrozenLake-v1", algorithm="reinforce", time_aware=True, episodes=1).config
    other = qtab.Config(algorithm="reinforce", time_aware=True).replace(algorithm="actor_critic")
    assert (other.on_truncation, other.time_aware) == ("terminate", True)
    trained = qtab.train("FrozenLake-v1", config=config, algorithm="actor_critic", episodes=1).config
    assert (trained.on_truncation, trained.time_aware) == ("terminate", True)
    with pytest.raises(ValueError, match=r"^on_truncation must be 'terminate' for algorithm 'reinforce'"):
        config.replace(algorithm="reinforce", on_truncation="bootstrap")
