"""What the page knows of environments and settings agrees with the package."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.config.choices import CHOICES
from qtab.config.config import DEFAULTS
from qtab.config.options import OPTIONS
from qtab.playground import definitions
from qtab.playground.settings import LEFT_OUT, OFFERED

ENVIRONMENTS = definitions()["environments"]
SETTINGS = definitions()["settings"]


def test_every_setting_is_shown_or_left_out_on_purpose():
    assert not SETTINGS.keys() & LEFT_OUT
    for name in DEFAULTS.keys() - SETTINGS.keys() - LEFT_OUT:
        option = OPTIONS[name]
        assert set(option.values).isdisjoint(OFFERED[option.choice]), f"{name} applies to what the page offers"


def test_what_the_page_offers_exists():
    for name, words in OFFERED.items():
        assert set(words) <= set(CHOICES[name])


def test_every_setting_has_a_sentence_and_a_default():
    for name, setting in SETTINGS.items():
        assert setting["sentence"], name
        assert setting["default"] is not None or name in ("max_episode_steps", "low", "high"), name


@pytest.mark.parametrize(
    "name", [name for name, setting in SETTINGS.items() if setting["type"] in ("number", "integer")]
)
def test_the_ends_of_a_range_are_valid_settings(name):
    setting = SETTINGS[name]
    option = OPTIONS.get(name)
    beside: dict[str, Any] = {"episodes": 100_000} if name.endswith("warm_up") else {}
    while option is not None:
        beside[option.choice] = option.values[0]
        option = OPTIONS.get(option.choice)
    if name == "min_learning_rate":
        beside["learning_rate"] = 1.0
    if name == "min_epsilon":
        beside["epsilon"] = 1.0
    for value in (setting["low"], setting["high"]):
        assert getattr(qtab.Config(**{**beside, name: value}), name) == value


@pytest.mark.parametrize("key", ENVIRONMENTS)
def test_presets_are_valid(key):
    for preset in ENVIRONMENTS[key]["presets"].values():
        config: Any = {name: tuple(value) if isinstance(value, list) else value for name, value in preset.items()}
        qtab.Config(**config)
        assert preset["discretizer"] in ENVIRONMENTS[key]["discretizers"]
        assert preset.keys() <= SETTINGS.keys()


@pytest.mark.parametrize(
    "key", [key for key, known in ENVIRONMENTS.items() if known["drawing"] in ("frozen_lake", "cliff")]
)
def test_maps_are_gymnasiums(key):
    known = ENVIRONMENTS[key]
    env: Any = gym.make(known["python"], **known["env_kwargs"]).unwrapped
    cells = "".join(known["layout"])
    assert len(cells) == known["states"] == env.observation_space.n
    assert [cell == "S" for cell in cells] == (np.asarray(env.initial_state_distrib) > 0).tolist()


@pytest.mark.parametrize("rule", definitions()["rules"], ids=lambda rule: f"{rule['setting']}={rule['value']}")
def test_python_refuses_what_a_rule_excludes(rule):
    beside: dict[str, Any] = (
        {"scale": (10.0, 100.0)} if rule["unless"].get("discretizer") not in ("tiles", "fourier") else {}
    )
    if rule["setting"] == "traces":
        beside = {**beside, "algorithm": "sarsa_lambda"}
    with pytest.raises(ValueError, match=f"^{rule['setting']} must be "):
        qtab.Config(**{**beside, rule["setting"]: rule["value"], **rule["unless"]})


def test_a_discretizer_brings_the_settings_that_python_gives_it():
    found = definitions()["implied"]
    assert found.keys() == {"fourier"}
    config = qtab.train(
        "MountainCar-v0", discretizer="fourier", algorithm="sarsa_lambda", episodes=1, progress=False
    ).config
    assert {name: getattr(config, name) for name in found["fourier"]} == found["fourier"]


def test_nothing_is_said_of_what_is_not_offered():
    for name, setting in SETTINGS.items():
        assert "preference" not in setting["sentence"], name
        assert "ucb" not in setting["sentence"], name
        if setting["choices"]:
            assert {choice["value"] for choice in setting["choices"]} <= {*OFFERED[name]}, name
        if applies := setting["applies"]:
            assert {*applies["values"]} <= {*OFFERED[applies["choice"]]}, name
