"""All exercises, by name and by number."""

from collections.abc import Mapping

from qtab._utils.shown import did_you_mean, shown
from qtab.exercises.definitions import (
    dyna_q,
    epsilon_greedy,
    expected_sarsa,
    monte_carlo,
    n_step_sarsa,
    policy_evaluation,
    q_learning,
    sample_average,
    sarsa,
    sarsa_lambda,
    td_prediction,
    value_iteration,
)
from qtab.exercises.exercise import Exercise

EXERCISES: Mapping[str, Exercise] = {
    module.EXERCISE.name: module.EXERCISE
    for module in (
        epsilon_greedy,
        sample_average,
        policy_evaluation,
        value_iteration,
        monte_carlo,
        td_prediction,
        sarsa,
        q_learning,
        expected_sarsa,
        n_step_sarsa,
        dyna_q,
        sarsa_lambda,
    )
}
"""The exercises by their names, in the book's order."""


def find(exercise: str | int) -> Exercise:
    """Returns an exercise; ``print(find("sarsa").starter)`` shows its task.

    Args:
        exercise: Its name, such as ``"sarsa"``, or its number, such as 7 or ``"7"``.

    Raises:
        ValueError: if there is no such exercise.
        TypeError: if ``exercise`` is neither text nor an integer.
    """
    if isinstance(exercise, bool) or not isinstance(exercise, str | int):
        raise TypeError(f"exercise must be a name or a number, got {shown(exercise)}")
    name = str(exercise).strip().lower().replace("-", "_").replace(" ", "_")
    for found in EXERCISES.values():
        if name in (found.name, str(found.number)):
            return found
    raise ValueError(f"there is no exercise {exercise!r}{did_you_mean(name, EXERCISES)}: see qtab.exercises.EXERCISES")
