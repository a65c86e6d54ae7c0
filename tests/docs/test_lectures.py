"""The grid of a link in the plan of lectures is solved with the settings of the link."""

import re
from typing import Any
from urllib.parse import parse_qs

import qtab
from qtab.envs.grid_worlds import grid_world
from support.repository import ROOT

DEFAULTS = {"learning_rate": 0.5, "epsilon": 0.1, "epsilon_schedule": "constant", "initial_q": 0.0, "ties": "first"}
"""The settings with which the playground opens a painted grid."""


def test_the_agent_of_the_second_lecture_reaches_the_goal() -> None:
    text = (ROOT / "docs/teaching/lectures.md").read_text(encoding="utf-8")
    (link,) = re.findall(r"<(env=grid&layout=[^>]*)>", text)
    given = {name: value for name, (value,) in parse_qs(link).items() if name != "env"}
    layout = given.pop("layout").replace("W", "#").split("/")
    step, goal = (float(given.pop(name)) for name in ("step_reward", "goal_reward"))
    settings: dict[str, Any] = {
        **DEFAULTS,
        "discount": float(given.pop("discount")),
        "episodes": int(given.pop("episodes")),
        **given,
    }
    run = qtab.train(grid_world(layout, step_reward=step, goal_reward=goal), seed=0, max_episode_steps=1000, **settings)
    shortest = 8
    assert shortest <= run.episode_lengths[-100:].mean() < 2 * shortest
