"""What a preset says never contradicts what a wrapper made of the spaces, and no error quotes it as the user's."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import wrappers

import qtab
from support.parity import assert_same_run

SHORT: dict[str, Any] = {"episodes": 2, "seed": 0, "max_episode_steps": 20}


@pytest.mark.parametrize("preset", ["article", "solved"])
def test_a_preset_of_a_box_leaves_its_discretizer_out_for_a_discrete_space(preset: str) -> None:
    env = wrappers.DiscretizeObservation(gym.make("MountainCar-v0"), 7)
    run = qtab.train(env, preset=preset, **SHORT)
    assert (run.config.discretizer, run.config.preset) == ("identity", preset)
    assert run.config.learning_rate <= 1
    assert (run.config.tiles, run.config.low, run.config.scale) == (None, None, ())
    assert run.config.algorithm == ("q_learning" if preset == "article" else "true_online_sarsa_lambda")


def test_the_actions_of_a_preset_are_left_out_for_discrete_actions() -> None:
    env = wrappers.DiscretizeAction(gym.make("MountainCarContinuous-v0"), 5)
    run = qtab.train(env, **SHORT)
    assert run.config.actions is None
    assert len(run.actions) == 5
    assert run.config.tiles == (16, 16)


def test_the_limits_of_a_preset_are_left_out_in_other_units() -> None:
    env = gym.make("CartPole-v1")
    bounded = wrappers.TransformObservation(env, np.tanh, gym.spaces.Box(-1, 1, (4,), np.float32))
    run = qtab.train(bounded, **SHORT)
    assert run.config.discretizer == "bins"
    assert (run.config.low, run.config.high, run.config.bins) == ((-1.0,) * 4, (1.0,) * 4, (10,) * 4)
    assert qtab.train(env, **SHORT).config.bins == (3, 3, 6, 6)


def test_a_setting_that_was_asked_for_stays() -> None:
    env = wrappers.RescaleObservation(gym.make("MountainCar-v0"), np.float32(-1), np.float32(1))
    assert qtab.train(env, scale=(10, 100), **SHORT).q_table.shape == (21, 201, 3)


@pytest.mark.filterwarnings("ignore")  # of Gymnasium's wrapper
def test_a_wrapper_that_keeps_the_units_keeps_the_preset() -> None:
    plain = qtab.train(gym.make("MountainCar-v0"), backend="gymnasium", **SHORT)
    for wrap in (
        lambda env: wrappers.DtypeObservation(env, np.float64),
        lambda env: wrappers.ReshapeObservation(env, (1, 2)),
    ):
        run = qtab.train(wrap(gym.make("MountainCar-v0")), **SHORT)
        assert run.config.scale == plain.config.scale == (10.0, 100.0)
    assert_same_run(
        qtab.train(wrappers.OrderEnforcing(gym.make("MountainCar-v0")), backend="gymnasium", **SHORT), plain
    )


WRONG: list[tuple[str, Any, dict[str, Any]]] = [
    ("MountainCar-v0", lambda env: wrappers.FrameStackObservation(env, 2), {}),
    ("MountainCar-v0", wrappers.TimeAwareObservation, {}),
    ("MountainCar-v0", wrappers.NormalizeObservation, {}),
    ("MountainCar-v0", lambda env: wrappers.RescaleObservation(env, np.float32(-1), np.float32(1)), {}),
    ("CartPole-v1", lambda env: wrappers.FrameStackObservation(env, 2), {}),
    ("CartPole-v1", wrappers.TimeAwareObservation, {"preset": "solved"}),
    ("MountainCarContinuous-v0", lambda env: wrappers.RescaleAction(env, np.float32(0), np.float32(1)), {}),
    ("MountainCarContinuous-v0", lambda env: wrappers.FrameStackObservation(env, 9), {}),
]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("name", "wrap", "settings"), WRONG)
def test_no_error_quotes_a_presets_number_as_the_users(name: str, wrap: Any, settings: dict[str, Any]) -> None:
    preset = qtab.presets(name)[settings.get("preset") or next(iter(qtab.presets(name)))]
    with pytest.raises(ValueError) as caught:
        qtab.train(wrap(gym.make(name)), **settings, **SHORT)
    text = str(caught.value)
    for setting in ("scale", "bins", "low", "high", "tiles", "actions"):
        if (value := preset.get(setting)) is not None and f"got {value!r}"[:-1] in text:
            assert f"this is the {setting} of preset " in text
    assert "\n" not in text


def test_a_value_of_the_preset_that_does_not_fit_the_users_is_named() -> None:
    with pytest.raises(
        ValueError, match=r"high must .* got \(2.4, .*\); this is the high of preset 'tuned'; give another"
    ):
        qtab.train("CartPole-v1", low=(3, 3, 3, 3))
    with pytest.raises(ValueError, match=r"high must lie above low = .* got \(2.4, [^;]*\)$"):
        qtab.train("CartPole-v1", low=(3, 3, 3, 3), high=(2.4, 2.0, 0.21, 2.0))
