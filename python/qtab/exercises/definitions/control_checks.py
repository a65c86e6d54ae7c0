"""The checks of learners of action values: without exploring, exploring, and with a short time limit."""

from collections.abc import Mapping, Sequence
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
    own = [{name: values[index] for name, values in options.items()} for index in range(3)]
    cliff = LearnerCheck(
        title=f"CliffWalking-v1 without exploring, 3 episodes of at most 60 steps{_listed(own[0])}",
        model=model,
        env_id="CliffWalking-v1",
        episodes=3,
        max_episode_steps=60,
        settings={"learning_rate": 0.5, "discount": 0.9, "epsilon": 0.0, **own[0]},
        seed=1,
    )
    rates = {"learning_rate": 0.2, "discount": 0.95, "epsilon": 0.3}
    title = "FrozenLake-v1, 30 episodes that all end in a terminal state"
    ending = _on_lake(title, model, 1000, rates, own[1], seed=2)
    rates = {"learning_rate": 0.3, "discount": 0.8, "epsilon": 0.2}
    title = "FrozenLake-v1, 30 episodes of at most 5 steps: many are truncated"
    return [cliff, ending, _on_lake(title, model, 5, rates, own[2], seed=3)]


def _on_lake(
    title: str, model: Solution, steps: int, rates: Mapping[str, float], own: Mapping[str, Any], seed: int
) -> LearnerCheck:
    """Returns a check of 30 episodes on FrozenLake, from random values."""
    settings = {**rates, **own}
    return LearnerCheck(f"{title}{_listed(own)}", model, "FrozenLake-v1", 30, steps, settings, spread=1.0, seed=seed)


def _listed(own: Mapping[str, Any]) -> str:
    return "".join(f", {name} = {value}" for name, value in own.items())
