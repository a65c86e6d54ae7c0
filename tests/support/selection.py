"""Which tests run, and in which order."""

import re
from collections.abc import Sequence
from typing import TypeVar

T = TypeVar("T")

MUST_BE_NAMED = ("browser", "docs", "sb3", "third_party")
"""The markers of tests that run only if ``-m`` names them, as they need more than the extra ``test`` installs."""


def without_unnamed(expression: str) -> str:
    """Returns the expression of ``-m``, extended by the markers that must be named and are not."""
    unnamed = [f"not {marker}" for marker in MUST_BE_NAMED if not re.search(rf"\b{marker}\b", expression)]
    return " and ".join(([f"({expression})"] if expression and unnamed else [expression] * bool(expression)) + unnamed)


def slow_first(tests: Sequence[T], slow: Sequence[bool], processes: int) -> list[T]:
    """Returns the tests in an order in which no process still has a slow one when the others have finished.

    pytest-xdist gives every process an equal part of the order; a process that has finished its own takes tests from
    the end of another's. Each part therefore starts with its share of the slow tests.

    Args:
        tests: The tests, in the order of their files.
        slow: Which of them are slow.
        processes: The number of processes.
    """
    kinds = [[test for test, is_slow in zip(tests, slow, strict=True) if is_slow is kind] for kind in (True, False)]
    ordered: list[T] = []
    for part in range(processes):
        for kind in kinds:
            ordered += kind[len(kind) * part // processes : len(kind) * (part + 1) // processes]
    return ordered
