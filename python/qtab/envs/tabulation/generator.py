"""A generator whose draws have each of their values in turn."""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from qtab.envs.tabulation.branches import MOST_OUTCOMES, MOST_VALUES, Branches, uniformly
from qtab.envs.tabulation.uniform import Uniform

_COMPARED = "only comparisons of random() with < and > can be listed"


class ListingGenerator(np.random.Generator):
    """A NumPy generator whose draws have each of their values in turn, with exact probabilities.

    It lists ``integers``, ``choice``, ``permutation``, ``shuffle`` and ``binomial``. ``random`` and ``uniform`` return
    a :class:`Uniform`. Other draws are refused. Arguments that NumPy rejects raise NumPy's errors, and the values have
    NumPy's types.

    Args:
        branches: The draws of the function.
    """

    def __init__(self, branches: Branches) -> None:
        super().__init__(np.random.PCG64(0))
        self._branches = branches
        self._numpy = np.random.default_rng(0)
        """A generator that checks arguments, and whose values show the types."""

    def __deepcopy__(self, memo: Any) -> "ListingGenerator":
        return self

    @property
    def bit_generator(self) -> Any:
        """Refused: its draws are not seen."""
        raise self._branches.refused("rng.bit_generator, whose draws cannot be listed")

    def random(self, size: Any = None, dtype: Any = np.float64, out: Any = None) -> Any:
        """Returns a uniform number in [0, 1) that can be compared."""
        if size is not None or out is not None or np.dtype(dtype) != np.float64:
            raise self._branches.refused(f"rng.random(size={size}), several continuous numbers; {_COMPARED}")
        return Uniform(self._branches, "rng.random()")

    def uniform(self, low: Any = 0.0, high: Any = 1.0, size: Any = None) -> Any:
        """Returns a uniform number in [low, high) that can be compared."""
        self._numpy.uniform(low, high, size)
        if size is not None or np.ndim(low) or np.ndim(high):
            raise self._branches.refused(f"rng.uniform({low}, {high}, size={size}), continuous numbers; {_COMPARED}")
        call = f"rng.uniform({low}, {high})"
        if not low < high:
            raise self._branches.refused(f"{call}, an interval without values")
        return Uniform(self._branches, call, float(low), float(high))

    def integers(
        self, low: Any, high: Any = None, size: Any = None, dtype: Any = np.int64, endpoint: bool = False
    ) -> Any:
        """Returns an integer from ``low`` up to ``high``, or an array of them."""
        call = f"rng.integers({low}{'' if high is None else f', {high}'})"
        if np.ndim(low) or (high is not None and np.ndim(high)):
            raise self._branches.refused(f"{call}, with an array of bounds")
        like = self._numpy.integers(low, high, size, dtype, endpoint)
        first, end = (0, int(low)) if high is None else (int(low), int(high))
        return self._filled(call, first, uniformly(end + bool(endpoint) - first), like)

    def binomial(self, n: Any, p: Any, size: Any = None) -> Any:
        """Returns the number of successes in ``n`` trials, or an array of them."""
        call = f"rng.binomial({n}, {p})"
        if np.ndim(n) or np.ndim(p) or n >= MOST_VALUES:
            raise self._branches.refused(f"{call}, with an array or too many trials")
        like = self._numpy.binomial(n, p, size)
        trials, success = int(n), Fraction(float(p))
        of_count = (
            math.comb(trials, count) * success**count * (1 - success) ** (trials - count) for count in range(trials + 1)
        )
        return self._filled(call, 0, tuple(of_count), like)

    def choice(
        self, a: Any, size: Any = None, replace: bool = True, p: Any = None, axis: int = 0, shuffle: bool = True
    ) -> Any:
        """Returns one of the items, or an array of them."""
        like = self._numpy.choice(a, size, replace, p, axis, shuffle)
        items = np.arange(a) if isinstance(a, int | np.integer) else np.asarray(a)
        count = items.shape[axis]
        call = f"rng.choice of {count} items"
        if size is None:
            probabilities = uniformly(count) if p is None else _shares(p)
            chosen = np.take(items, self._branches.draw(call, probabilities), axis)
            return chosen if isinstance(like, np.ndarray) else type(like)(chosen)
        if replace:
            probabilities = uniformly(count) if p is None else _shares(p)
            self._check_few(call, len(probabilities) ** int(np.prod(size)))
            indices = [self._branches.draw(call, probabilities) for _ in range(int(np.prod(size)))]
        else:
            if p is not None or not shuffle:
                raise self._branches.refused(f"{call}, without replacement and with p or without shuffle")
            indices = self._order(call, count, int(np.prod(size)))
        return np.take(items, np.reshape(np.array(indices, np.intp), size), axis)

    def permutation(self, x: Any, axis: int = 0) -> Any:
        """Returns the items in any order."""
        items = np.arange(x) if isinstance(x, int | np.integer) else np.array(x)
        count = items.shape[axis]
        return np.take(items, self._order(f"rng.permutation of {count} items", count, count), axis)

    def shuffle(self, x: Any, axis: int = 0) -> None:
        """Puts the items of a list or an array into any order."""
        count = x.shape[axis] if isinstance(x, np.ndarray) else len(x)
        order = self._order(f"rng.shuffle of {count} items", count, count)
        x[:] = np.take(x, order, axis) if isinstance(x, np.ndarray) else [x[index] for index in order]

    def _check_few(self, call: str, outcomes: int) -> None:
        """Refuses a call with too many outcomes at once, rather than after the most that are allowed."""
        if outcomes > MOST_OUTCOMES:
            raise self._branches.refused(f"{call}, which has more than {MOST_OUTCOMES:,} outcomes")

    def _order(self, call: str, count: int, chosen: int) -> list[int]:
        """Returns indices without repetition, of which each order is equally likely."""
        self._check_few(call, math.perm(count, chosen))
        left = list(range(count))
        return [left.pop(self._branches.draw(call, uniformly(len(left)))) for _ in range(chosen)]

    def _filled(self, call: str, first: int, probabilities: Sequence[Fraction], like: Any) -> Any:
        """Returns a drawn integer, or an array of drawn integers, of the type of ``like``."""
        if not isinstance(like, np.ndarray):
            return type(like)(first + self._branches.draw(call, probabilities))
        self._check_few(f"{call[:-1]}, size={like.shape})", len(probabilities) ** like.size)
        numbers = [first + self._branches.draw(call, probabilities) for _ in range(like.size)]
        return np.array(numbers, like.dtype).reshape(like.shape)

    def __getattribute__(self, name: str) -> Any:
        if not name.startswith("_") and name not in _LISTED:
            refused = object.__getattribute__(self, "_branches").refused
            raise refused(f"rng.{name}, whose outcomes cannot be listed")
        return object.__getattribute__(self, name)


_LISTED = frozenset(name for name in vars(ListingGenerator) if not name.startswith("_"))
"""The methods of a generator that are listed, and the refused attribute."""


def _shares(p: Any) -> tuple[Fraction, ...]:
    weights = [Fraction(float(weight)) for weight in p]
    total = sum(weights)
    return tuple(weight / total for weight in weights)
