"""All exercises, by name and by number."""

from collections.abc import Mapping
from importlib import import_module

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


def find(exercise: str | int | Exercise) -> Exercise:
    """Returns an exercise; ``print(find("sarsa").starter)`` shows its task.

    Args:
        exercise: Its name, such as ``"sarsa"``, or its number, such as 7 or ``"7"``. An exercise of your own is
            ``"module:NAME"``, the module that defines it and its name there, or the exercise itself.

    Raises:
        ValueError: if there is no such exercise.
        TypeError: if ``exercise`` is neither text, an integer nor an exercise.
        ImportError: if the module of an exercise of your own cannot be imported.
    """
    if isinstance(exercise, Exercise):
        return exercise
    if isinstance(exercise, str) and ":" in exercise:
        return _own(exercise)
    if isinstance(exercise, bool) or not isinstance(exercise, str | int):
        raise TypeError(f"exercise must be a name, a number or an Exercise, got {shown(exercise)}")
    name = str(exercise).strip().lower().replace("-", "_").replace(" ", "_")
    for found in EXERCISES.values():
        if name in (found.name, str(found.number)):
            return found
    suggestion = did_you_mean(name, EXERCISES) or f": they are numbered from 1 to {len(EXERCISES)}"
    raise ValueError(f"there is no exercise {exercise!r}{suggestion}; qtab.exercises.EXERCISES lists them")


def _own(exercise: str) -> Exercise:
    """Returns an exercise that a module defines, by ``"module:NAME"``."""
    module, _, name = exercise.partition(":")
    if not module or module.startswith("."):
        raise ValueError(f"exercise must be module:NAME, got {exercise!r}")
    defined = {key: value for key, value in vars(import_module(module)).items() if isinstance(value, Exercise)}
    if name in defined:
        return defined[name]
    known = f"its exercises are {', '.join(defined)}" if defined else "it defines no exercise"
    raise ValueError(f"exercise must be module:NAME, got {exercise!r}{did_you_mean(name, defined)}: {known}")
