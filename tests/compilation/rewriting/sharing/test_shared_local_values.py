"""Local lists and arrays with two names: where one changes and the other would show it, they are refused."""

from typing import Any

import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line
from support.lockstep.rewriting import assert_equal_steps

FIRST = slice(0, 2)


class Ravels(ExtraEnv):
    def extra(self):
        grid = np.zeros((2, 2))
        flat = grid.ravel()
        grid[0, 0] = 5.0  # here
        return float(flat[0])


class TakesAsArray(ExtraEnv):
    def extra(self):
        first = np.zeros(2)
        second = np.asarray(first)
        first[0] = 5.0  # here
        return float(second[0])


class LoopsOverPart(ExtraEnv):
    def extra(self):
        values, total = np.zeros(4), 0.0
        for value in values[1:]:
            values[3] = 7.0  # here
            total += value
        return total


class LoopsOverParts(ExtraEnv):
    def extra(self):
        values, total = np.zeros(4), 0.0
        for part in (values[:2], values[1:3]):
            values[2] += 7.0  # here
            total += part[1]
        return total


class AddsToPair(ExtraEnv):
    def extra(self):
        first = [self.cell, 2]
        pair: Any = ()
        pair += (first,)
        first += [3]  # here
        return float(len(pair[0]))


class AddsPairs(ExtraEnv):
    def extra(self):
        first = [1, 2]
        pair = (first,) + (1,)  # noqa: RUF005 - the operator is tested
        first += [3]  # here
        return float(len(pair[0]))


class RepeatsList(ExtraEnv):
    def extra(self):
        first = [1, 2]
        pair = [first] * 2
        first += [3]  # here
        return float(len(pair[0]))


class ListsParts(ExtraEnv):
    def extra(self):
        values = np.zeros(4)
        pair = [values[:2] for _ in range(2)]
        values[0] = 5.0  # here
        return float(pair[1][0])


class TakesLarger(ExtraEnv):
    def extra(self):
        first = [1, 2]
        larger = max(first, [0])
        first += [3]  # here
        return float(len(larger))


class ExchangesRows(ExtraEnv):
    def extra(self):
        grid = np.zeros((2, 2))
        grid[0] = 1.0 * self.cell
        grid[0], grid[1] = grid[1], grid[0]  # here
        return float(grid[1, 0])


class ExchangesHalves(ExtraEnv):
    def extra(self):
        values = np.zeros(4)
        values[0] = 1.0 * self.cell
        values[:2], values[2:] = values[2:], values[:2]  # here
        return float(values[2])


class ExchangesByMethod(ExtraEnv):
    def exchanged(self, grid):
        return grid[1], grid[0]

    def extra(self):
        grid = np.zeros((2, 2))
        grid[0] = 1.0 * self.cell
        grid[0], grid[1] = self.exchanged(grid)  # here
        return float(grid[1, 0])


class KeepsRow(ExtraEnv):
    def extra(self):
        grid = np.ones((2, 2))
        grid[0], row = 2.0 * grid[1], grid[0]  # here
        return float(row[0])


class ExchangesLater(ExtraEnv):
    def extra(self):
        grid = np.zeros((2, 2))
        rows = grid[1], grid[0]
        grid[0, 0] = 1.0 * self.cell  # here
        return float(rows[1][0])


class UnpacksIntoElements(ExtraEnv):
    def extra(self):
        values = np.zeros(4)
        part = values[:2]
        values[0], values[1] = 1.0, 2.0  # here
        return float(part[0])


class NamesSlice(ExtraEnv):
    def extra(self):
        values = np.zeros(4)
        part = values[FIRST]  # here
        values[0] = 5.0
        return float(part[0])


class NamesSliceOfRow(ExtraEnv):
    def extra(self):
        grid = np.zeros((2, 2))
        part = grid[0, FIRST]  # here
        grid[0, 0] = 5.0
        return float(part[0])


class ChangesRavelled(ExtraEnv):
    def extra(self):
        grid = np.zeros((2, 2))
        flat = grid.ravel()
        flat[0] = 5.0  # here
        return float(grid[0, 0])


class ExchangesRavelled(ExtraEnv):
    def extra(self):
        grid = np.ones((2, 2))
        grid[0] = 1.0 * self.cell
        grid[0], grid[1] = grid[1].ravel(), np.asarray(grid[0])  # here
        return float(grid[1, 0])


class GrowsInLoop(ExtraEnv):
    def extra(self):
        values, total = [1, 2], 0
        for value in values:
            if len(values) < 4:
                values += [value]  # here
            total += value
        return float(total)


class Annotates(ExtraEnv):
    def extra(self):
        values = np.zeros(3)
        part = values[:2]
        values[0]: float = 5.0  # type: ignore[misc]  # here
        return float(part[0])


class LoopsIntoElement(ExtraEnv):
    def extra(self):
        values = np.zeros(3)
        part = values[:2]
        for values[0] in range(3):  # here
            pass
        return float(part[0])


class TakesOfTuple(ExtraEnv):
    def extra(self):
        first, second = np.zeros(3), np.ones(3)
        taken = (first, second)[self.cell % 2]
        first[0] = 2.0  # here
        return float(taken[0] + second[0])


class AddsToTaken(ExtraEnv):
    def extra(self):
        first = np.zeros(3)
        taken = [first][0]
        first += 2.0  # here
        return float(taken[0])


class AddsInLoop(ExtraEnv):
    def extra(self):
        values, total = np.zeros(3), 0.0
        for value in values:
            values += 1.0  # here
            total += value
        return total


class ListsBoth(ExtraEnv):
    def extra(self):
        first, second = np.zeros(3), np.ones(3)
        both = [one for one in (first, second)]  # noqa: C416 - the comprehension is tested
        first += 1.0  # here
        return float(both[0][0] + second[0])


SHARED = [
    *(Ravels, TakesAsArray, LoopsOverPart, LoopsOverParts, AddsToPair, AddsPairs, RepeatsList, ListsParts),
    *(TakesLarger, ExchangesRows, ExchangesHalves, ExchangesByMethod, KeepsRow, ExchangesLater, UnpacksIntoElements),
    *(TakesOfTuple, AddsToTaken, AddsInLoop, ListsBoth),
    *(NamesSlice, NamesSliceOfRow, ChangesRavelled, ExchangesRavelled, GrowsInLoop, Annotates, LoopsIntoElement),
]


@pytest.mark.parametrize("cls", SHARED, ids=lambda cls: cls.__name__)
def test_local_values_with_two_names_are_refused_where_one_changes(cls: Any) -> None:
    reasons = (
        "shares? (the |its )?memory",
        "may have another name",
        "is read, and changed",
        "a slice kept",
        "a loop that",
    )
    with pytest.raises(NotCompilable, match="|".join(reasons)) as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)


class Copies(ExtraEnv):
    """Changes values that have no other name."""

    def extra(self):
        grid, total = np.zeros((2, 2)), 0.0
        flat = grid.ravel().copy()
        grid[0, 0] = 5.0
        scaled = 2.0 * grid + 1.0
        grid[0, 1] = scaled[0, 0]
        larger = max(grid[0, 0], 1.0)
        for value in scaled[1:, 0]:
            total += value
        return float(flat[0] + grid[0, 1] + larger + total)


class TakesElements(ExtraEnv):
    """Keeps elements of arrays, which are numbers and show no change."""

    def doubled(self, value):
        return 2.0 * value

    def extra(self):
        values, grid, total = np.zeros(3), np.zeros((2, 2)), 0.0
        values[0], grid[1] = 1.0 * self.cell, 2.0
        first, corner = values[0], grid[1, 0]
        values[0], grid[1, 0] = 5.0, 6.0
        values[1], values[2] = values[2], values[1]
        grid[0], grid[1] = grid[1].copy(), 3.0 * grid[0]
        pair = [values[0], grid[0, 0]]
        values[0] += self.doubled(values[0])
        for i in range(3):
            before = values[i]
            values[i] = before + 1.0
            total += before
        return float(first + corner + pair[0] + pair[1] + values[0] + total)


@pytest.mark.parametrize("cls", [Copies, TakesElements])
def test_copies_and_numbers_are_compiled(cls: type[ExtraEnv]) -> None:
    assert_equal_steps(cls(), rewrite(cls()), 60, 3)
