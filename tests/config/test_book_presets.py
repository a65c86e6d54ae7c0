"""The presets named ``book`` are the settings of the figures that ``qtab book`` draws."""

from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.book import TrainingExperiment
from qtab.book.figures.chapter_08 import changing_mazes, figure_8_2
from qtab.book.figures.chapter_10 import figure_10_5
from qtab.config.merge import merge
from qtab.envs.grid_worlds import dyna_maze


def of_line(experiment: TrainingExperiment, line: str) -> Mapping[str, Any]:
    (found,) = (setting.config for setting in experiment.settings if setting.line == line)
    return dict(found)


@pytest.mark.parametrize(
    ("env", "figure"),
    [
        ("qtab/DynaMaze-v0", of_line(figure_8_2.EXPERIMENT, "n = 50")),
        ("qtab/BlockingMaze-v0", of_line(changing_mazes.FIGURE_8_4, "Dyna-Q+")),
        ("qtab/ShortcutMaze-v0", of_line(changing_mazes.FIGURE_8_5, "Dyna-Q+")),
    ],
)
def test_the_presets_of_mazes_are_those_of_their_figures(env: str, figure: Mapping[str, Any]) -> None:
    assert qtab.presets(env)["book"] == figure
    assert merge(env) == merge(env, figure)
    assert qtab.train(env, episodes=5, seed=0).episode_returns.tolist() == [1.0] * 5


def test_the_dyna_maze_of_the_figure_is_the_registered_one() -> None:
    registered: Any = gym.make("qtab/DynaMaze-v0").unwrapped
    assert registered.P == dyna_maze().unwrapped.P  # type: ignore[attr-defined]


def test_the_queue_has_the_settings_of_its_figure_in_shorter_episodes() -> None:
    env, length = "qtab/AccessControlQueue-v0", ("episodes", "max_episode_steps")
    preset: dict[str, Any] = dict(qtab.presets(env)["book"])
    figure = dict(figure_10_5.CONFIG)
    steps = [config["episodes"] * config["max_episode_steps"] for config in (preset, figure)]
    assert steps == [figure_10_5.STEPS] * 2
    for config in (preset, figure):
        for name in length:
            del config[name]
    assert merge(env, preset) == merge(env, figure)
    # Its greedy policy receives up to 2.75 per step, and one that always accepts 1.8.
    run = qtab.train(env, episodes=10, seed=0)
    assert run.episode_returns[-1] > 2.4 * run.episode_lengths[-1]
