"""Draws that qtab.tabulate lists: the values, types and errors of NumPy's generator, with exact probabilities."""

from collections import Counter
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from qtab.envs.tabulation.branches import Branches
from qtab.envs.tabulation.generator import ListingGenerator


def listed(function):
    """The probabilities of the results of a function of a generator, in the order of their first appearance."""
    branches = Branches()
    rng = ListingGenerator(branches)
    sums: dict[Any, Fraction] = {}
    for probability, result in branches.outcomes(lambda: function(rng)):
        key = tuple(result.tolist()) if isinstance(result, np.ndarray) else result
        sums[key] = sums.get(key, Fraction(0)) + probability
    assert sum(sums.values()) == 1
    return sums


DRAWS = {
    "integers": lambda rng: rng.integers(2, 5),
    "integers below": lambda rng: rng.integers(3),
    "integers with the endpoint": lambda rng: rng.integers(1, 6, endpoint=True),
    "two integers": lambda rng: rng.integers(0, 3, size=2),
    "integers as bytes": lambda rng: rng.integers(0, 3, dtype=np.uint8),
    "choice of a number": lambda rng: rng.choice(4),
    "choice": lambda rng: rng.choice([5, 7]),
    "choice of words": lambda rng: rng.choice(["a", "b"]),
    "choice of rows": lambda rng: rng.choice([(0, 1), (1, 0)]),
    "weighted choice": lambda rng: rng.choice([5, 7, 9], p=[0.25, 0.0, 0.75]),
    "choices": lambda rng: rng.choice(2, size=(2,), p=[0.25, 0.75]),
    "choices without replacement": lambda rng: rng.choice(3, size=2, replace=False),
    "permutation": lambda rng: rng.permutation(3),
    "permutation of items": lambda rng: rng.permutation([4, 4, 5]),
    "binomial": lambda rng: rng.binomial(1, 0.25),
    "three trials": lambda rng: rng.binomial(3, 0.5),
    "two draws": lambda rng: rng.integers(0, 2) + rng.integers(0, 3),
    "a draw that depends on another": lambda rng: rng.integers(0, rng.integers(1, 4)),
    "comparison": lambda rng: rng.random() < 0.3,
    "comparison with NumPy's number": lambda rng: np.float64(0.3) > rng.random(),
    "comparison of a uniform number": lambda rng: rng.uniform(-1, 3) >= 0.0,
}


@pytest.mark.parametrize("name", DRAWS)
def test_a_listed_draw_has_numpys_values_and_types(name):
    draw, rng = DRAWS[name], np.random.default_rng(0)
    samples = 4000
    sampled = [draw(rng) for _ in range(samples)]
    counts = Counter(tuple(one.tolist()) if isinstance(one, np.ndarray) else one for one in sampled)
    chances = listed(draw)
    assert counts.keys() == chances.keys()
    for value, chance in chances.items():
        error = np.sqrt(float(chance * (1 - chance)) / samples)
        assert abs(counts[value] / samples - float(chance)) < 5 * error, value
    if "comparison" not in name:
        branches = Branches()
        first = next(branches.outcomes(lambda: draw(ListingGenerator(branches))))[1]
        assert type(first) is type(sampled[0])
        assert getattr(first, "dtype", None) == getattr(sampled[0], "dtype", None)


def test_outcomes_are_in_the_order_of_the_values():
    assert list(listed(lambda rng: (int(rng.integers(0, 2)), int(rng.integers(0, 2))))) == [
        (0, 0),
        (0, 1),
        (1, 0),
        (1, 1),
    ]
    assert list(listed(lambda rng: rng.random() < 0.3)) == [True, False]


def test_shuffle_changes_lists_and_arrays_in_place():
    def shuffled(items):
        def draw(rng):
            copy = items.copy()
            rng.shuffle(copy)
            return copy if isinstance(copy, np.ndarray) else tuple(copy)

        return draw

    for items in ([1, 2, 3], np.array([1, 2, 3])):
        assert set(listed(shuffled(items)).values()) == {Fraction(1, 6)}
        assert len(listed(shuffled(items))) == 6


def test_several_comparisons_divide_one_interval():
    def which(rng):
        number = rng.random()
        return "low" if number < 0.25 else "middle" if number <= 0.5 else "high" if number < 1.0 else "never"

    assert listed(which) == {"low": Fraction(1, 4), "middle": Fraction(1, 4), "high": Fraction(1, 2)}


def test_a_comparison_with_an_array_is_that_with_each_item():
    chances = listed(lambda rng: int(np.argmax(np.cumsum([0.25, 0.5, 0.25]) > rng.random())))
    assert chances == {0: Fraction(1, 4), 1: Fraction(1, 2), 2: Fraction(1, 4)}


@pytest.mark.parametrize("draw", [lambda rng: rng.choice(3, p=[0.5, 0.6, 0.0]), lambda rng: rng.binomial(1, 1.5)])
def test_numpys_errors_are_raised(draw):
    with pytest.raises(ValueError) as expected:
        draw(np.random.default_rng(0))
    with pytest.raises(ValueError) as found:
        listed(draw)
    assert str(found.value) == str(expected.value)
