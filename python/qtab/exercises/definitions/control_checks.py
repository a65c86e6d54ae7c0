"""The checks of learners of action values: without exploring, exploring, and with a short time limit."""

from typing import Any

from qtab.exercises.exercise import Solution
from qtab.exercises.learner_check import LearnerCheck


def control_checks(model: Solution, **options: Any) -> list[LearnerCheck]:
    """Returns three checks of a learner.

    Args:
        model: The learner of the reference.
        options: Its arguments besides those of all learners, such as ``n``.
    """
    return [
        LearnerCheck(
            title="CliffWalking-v1 without exploring, 3 episodes of at most 60 steps",
            model=model,
            env_id="CliffWalking-v1",
            episodes=3,
            max_episode_steps=60,
            settings={"learning_rate": 0.5, "discount": 0.9, "epsilon": 0.0, **options},
            seed=1,
        ),
        LearnerCheck(
            title="FrozenLake-v1, 30 episodes that all end in a terminal state",
            model=model,
            env_id="FrozenLake-v1",
            episodes=30,
            max_episode_steps=1000,
            settings={"learning_rate": 0.2, "discount": 0.95, "epsilon": 0.3, **options},
            spread=1.0,
            seed=2,
        ),
        LearnerCheck(
            title="FrozenLake-v1, 30 episodes of at most 5 steps: many are truncated",
            model=model,
            env_id="FrozenLake-v1",
            episodes=30,
            max_episode_steps=5,
            settings={"learning_rate": 0.3, "discount": 0.8, "epsilon": 0.2, **options},
            spread=1.0,
            seed=3,
        ),
    ]
