"""A solution that ignores one of its arguments fails."""

from copy import deepcopy
from functools import partial
from typing import Any

import numpy as np
import pytest

from qtab.exercises import EXERCISES, check
from qtab.exercises.exercise import parameters
from qtab.exercises.record import Misuse, Record, first_difference

NAMES = sorted(EXERCISES)


def calls_of(name: str, index: int) -> list[tuple[Any, ...]]:
    """Returns the arguments of all calls in a check."""
    calls: list[tuple[Any, ...]] = []

    def noted(*arguments: Any) -> Any:
        calls.append(arguments)
        return EXERCISES[name].model(*arguments)

    EXERCISES[name].checks[index].run(noted, Record(), 60.0)
    return calls


@pytest.mark.parametrize(
    ("name", "argument"),
    [
        (name, argument)
        for name in NAMES
        for argument in parameters(EXERCISES[name].model)
        if argument not in ("env", "rng", "P", "policy", "features", "q", "w", "estimates", "counts")
    ],
)
def test_an_ignored_argument_fails(name: str, argument: str) -> None:
    exercise = EXERCISES[name]
    position = parameters(exercise.model).index(argument)

    def ignores(value: Any, *arguments: Any) -> Any:
        return exercise.model(*arguments[:position], value, *arguments[position + 1 :])

    for index in range(len(exercise.checks)):
        value = deepcopy(calls_of(name, index)[0][position])
        records = []
        for one in exercise.checks:
            mine, reference = Record(), Record()
            one.run(exercise.model, reference, 60.0)
            try:
                one.run(partial(ignores, value), mine, 60.0)
            except Misuse as misuse:
                mine.faults.append(str(misuse))
            records.append(bool(mine.faults) or first_difference(mine, reference) is not None)
        assert any(records), (index, value)


def test_a_fixed_number_of_actions_fails() -> None:
    def five(values, epsilon, rng):
        return int(np.argmax(values) if rng.random() < 1 - epsilon else rng.integers(5))

    assert not check("epsilon_greedy", five).passed
