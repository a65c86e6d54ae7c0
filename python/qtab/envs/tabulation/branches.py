"""All outcomes of a function that draws random numbers, found by running it once for each combination of draws."""

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import TypeVar

T = TypeVar("T")

MOST_VALUES = 10_000
"""The most values that one draw may have."""
MOST_OUTCOMES = 100_000
"""The most combinations of draws in one call of a function."""
MOST_DRAWS = 1_000
"""The most draws in one run of a function; one that draws until a value fits would never end."""


class CannotListError(Exception):
    """The outcomes of a call cannot be listed. The message names the draw and the reason.

    Args:
        reason: The draw and the reason, after the words "it calls".
    """

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


class Branches:
    """The draws of a function as a tree, of which each run follows one branch.

    The first run takes the first value of every draw. Each later run takes the next value of the last draw that has one
    left, so that the outcomes come in the order of the values.
    """

    def __init__(self) -> None:
        self._path: list[tuple[int, str, Sequence[Fraction]]] = []
        """The draws of the current run: the index of the value, the call, the probabilities of the values."""
        self._depth = 0
        """The number of draws so far in the current run."""
        self.refusal: CannotListError | None = None
        """The first draw that cannot be listed, also if the function catches the exception."""

    def draw(self, call: str, probabilities: Sequence[Fraction]) -> int:
        """Returns the index of the value that a draw has in the current run.

        Args:
            call: The call in words, such as ``"rng.integers(0, 6)"``.
            probabilities: The probabilities of the values. Values without probability are left out.

        Raises:
            CannotListError: if there are too many values or draws, or if the function draws differently than in an
                earlier run with the same values.
        """
        if self._depth == MOST_DRAWS:
            raise self.refused(
                f"{call} and more than {MOST_DRAWS:,} draws in one call; to draw until a value fits, use rng.choice of "
                "the values that fit"
            )
        if self._depth == len(self._path):
            if len(probabilities) > MOST_VALUES:
                raise self.refused(f"{call}, which has {len(probabilities):,} values, more than {MOST_VALUES:,}")
            self._path.append((_next_likely(probabilities, 0), call, probabilities))
        index, expected, known = self._path[self._depth]
        if expected != call or len(known) != len(probabilities):
            raise self.refused(
                f"{call}, and with the same random numbers {expected} before: it depends on more than the state and rng"
            )
        self._depth += 1
        return index

    def refused(self, reason: str) -> CannotListError:
        """Returns the error for a draw that cannot be listed, and keeps the first one."""
        error = CannotListError(reason)
        if self.refusal is None:
            self.refusal = error
        return error

    @property
    def path(self) -> tuple[int, ...]:
        """The indices of the values in the current run."""
        return tuple(index for index, *_ in self._path)

    def probability(self) -> Fraction:
        """Returns the product of the probabilities of the draws in the current run."""
        product = Fraction(1)
        for index, _, probabilities in self._path:
            product *= probabilities[index]
        return product

    def outcomes(self, function: Callable[[], T]) -> Iterator[tuple[Fraction, T]]:
        """Yields the probability and the result of each run of a function. Its draws call :meth:`draw`.

        Raises:
            CannotListError: if the outcomes cannot be listed.
        """
        self._path.clear()
        self.refusal = None
        count = 0
        while True:
            yield self._run(function)
            count += 1
            if not self._advance():
                return
            if count == MOST_OUTCOMES:
                raise self.refused(f"{self._path[0][1]} and more, which have more than {MOST_OUTCOMES:,} outcomes")

    def _run(self, function: Callable[[], T]) -> tuple[Fraction, T]:
        self._depth = 0
        try:
            result = function()
        except Exception:
            if self.refusal is not None:  # which the function may have turned into another error
                raise self.refusal from None
            raise
        if self.refusal is not None:
            raise self.refusal
        if self._depth < len(self._path):
            raise self.refused(
                f"{self._path[self._depth][1]} in one of two runs with the same random numbers: it depends on more "
                "than the state and rng"
            )
        return self.probability(), result

    def _advance(self) -> bool:
        while self._path:
            index, call, probabilities = self._path.pop()
            following = _next_likely(probabilities, index + 1)
            if following < len(probabilities):
                self._path.append((following, call, probabilities))
                return True
        return False


def _next_likely(probabilities: Sequence[Fraction], index: int) -> int:
    while index < len(probabilities) and not probabilities[index]:
        index += 1
    return index


@lru_cache(maxsize=1024)
def uniformly(count: int) -> tuple[Fraction, ...]:
    """Returns equal probabilities of ``count`` values; with too many values to list, without their number."""
    return (Fraction(1, count),) * min(count, MOST_VALUES + 1)
