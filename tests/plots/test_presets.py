"""Every preset with every schedule and way of exploring can be plotted."""

import dataclasses
import itertools
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from matplotlib.figure import Figure

import qtab
from qtab.config.choices import CHOICES
from qtab.config.options import PREFERENCES
from qtab.config.presets import _PRESETS

AXES = Figure().subplots()
SOFTMAX: dict[str, Any] = {"exploration": "softmax", "temperature": 0.5}
EXPLORATIONS = [{}, SOFTMAX, *({"epsilon_schedule": name} for name in CHOICES["epsilon_schedule"])]
GREEDY = "epsilon", "min_epsilon", "epsilon_schedule", "ties"
"""Settings that do not apply to softmax exploration."""
RATES = CHOICES["learning_rate_schedule"]


def check(env: str, preset: Mapping[str, Any], exploration: Mapping[str, Any], rate: str) -> None:
    if rate == "visits" and preset.get("algorithm") == "true_online_sarsa_lambda":
        rate = "linear"  # it has one learning rate for all weights
    settings = {**preset, **exploration, "learning_rate_schedule": rate}
    if rate != "exponential":
        settings.pop("learning_rate_decay", None)
    if exploration is SOFTMAX:
        settings = {name: value for name, value in settings.items() if name not in GREEDY}
    run = qtab.train(env, **{**settings, "episodes": 2, "max_episode_steps": 10, "seed": 0})
    AXES.clear()
    ax = qtab.plot(run, AXES)
    notes = ax.get_title("right") + "".join(text.get_text() for text in ax.texts)
    greedy = preset.get("algorithm") not in PREFERENCES
    assert ("τ = 0.5" if exploration is SOFTMAX else "ε = " if greedy else "τ = 1") in notes
    assert ax.get_legend() is not None


@pytest.mark.parametrize("env", sorted(_PRESETS))
def test_every_preset_is_plotted_as_it_is_and_with_another_way_of_exploring(env: str) -> None:
    if env.startswith("LunarLander"):
        pytest.importorskip("Box2D", reason="LunarLander needs the extra box2d")
    rates, explorations = itertools.cycle(RATES), itertools.cycle(EXPLORATIONS)
    for preset in qtab.presets(env).values():
        # Missing actions, which -inf stands for, have no softmax.
        has_all_actions = not np.isneginf(np.array(preset.get("initial_q", 0.0))).any()
        others = explorations if preset.get("algorithm") not in PREFERENCES else iter([SOFTMAX])
        for exploration in [{}, next(others)] if has_all_actions else [{}]:
            check(env if env in gym.registry else f"qtab/{env}", preset, exploration, next(rates))


@pytest.mark.parametrize("rate", RATES)
def test_every_schedule_of_the_learning_rate_is_plotted_with_every_way_of_exploring(rate: str) -> None:
    for exploration in EXPLORATIONS:
        check("MountainCar-v0", {}, exploration, rate)


def test_a_setting_without_a_value_has_no_place_in_the_note() -> None:
    run = qtab.train("MountainCar-v0", episodes=2, seed=0, epsilon_schedule="constant", epsilon=0.25)
    assert dataclasses.asdict(run.config)["min_epsilon"] is None
    ax = qtab.plot(run)
    assert ax.get_title("right") == "α = 0.2, γ = 0.9, ε = 0.25, seed 0"
