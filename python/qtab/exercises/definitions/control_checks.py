"""The checks of learners of action values: without exploring, exploring, and with a short time limit."""

from collections.abc import Sequence
from typing import Any

from qtab.exercises.exercise import Solution
from qtab.exercises.learner_check import LearnerCheck


def control_checks(model: Solution, **options: Sequence[Any]) -> list[LearnerCheck]:
    """Returns three checks of a learner.

    Args:
        model: The learner of the reference.
        options: Its arguments besides those of all learners, such as ``n``: a different value for each check, so that
            a learner that ignores the argument fails.
    """
    settings = [{name: values[index] for name, values in options.items()} for index in range(3)]
    titles = ["".join(f", {name} = {value}" for name, value in given.items()) for given in settings]
    return [
        LearnerCheck(
            title=f"CliffWalking-v1 without exploring, 3 episodes of at most 60 steps{titles[0]}",
            model=model,
            env_id="CliffWalking-v1",
            episodes=3,
            max_episode_steps=60,
            settings={"learning_rate": 0.5, "discount": 0.9, "epsilon": 0.0, **settings[0]},
            seed=1,
        ),
        LearnerCheck(
            title=f"FrozenLake-v1, 30 episodes that all end in a terminal state{titles[1]}",
            model=model,
            env_id="FrozenLake-v1",
            episodes=30,
            max_episode_steps=1000,
            settings={"learning_rate": 0.2, "discount": 0.95, "epsilon": 0.3, **settings[1]},
            spread=1.0,
            seed=2,
        ),
        LearnerCheck(
            title=f"FrozenLake-v1, 30 episodes of at most 5 steps: many are truncated{titles[2]}",
            model=model,
            env_id="FrozenLake-v1",
            episodes=30,
            max_episode_steps=5,
            settings={"learning_rate": 0.3, "discount": 0.8, "epsilon": 0.2, **settings[2]},
            spread=1.0,
            seed=3,
        ),
    ]
