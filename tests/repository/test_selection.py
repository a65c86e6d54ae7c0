"""Which tests run, and in which order (`support/selection.py`)."""

import pytest

from support.selection import slow_first, without_unnamed


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("", "not browser and not docs and not sb3 and not third_party"),
        ("not slow", "(not slow) and not browser and not docs and not sb3 and not third_party"),
        ("slow or docs", "(slow or docs) and not browser and not sb3 and not third_party"),
        ("not third_party and sb3", "(not third_party and sb3) and not browser and not docs"),
        ("documents", "(documents) and not browser and not docs and not sb3 and not third_party"),
    ],
)
def test_kinds_that_must_be_named_are_left_out_unless_they_are(given: str, expected: str) -> None:
    assert without_unnamed(given) == expected
    # A process of pytest-xdist is given the extended expression, and extends it again.
    assert without_unnamed(expected) == expected


def test_each_process_starts_with_its_share_of_the_slow_tests() -> None:
    slow = [number % 5 == 4 for number in range(30)]
    ordered = slow_first(range(30), slow, 3)
    assert sorted(ordered) == [*range(30)]
    parts = [ordered[:10], ordered[10:20], ordered[20:]]
    assert [[slow[number] for number in part] for part in parts] == [[True] * 2 + [False] * 8] * 3
    assert [part[:2] for part in parts] == [[4, 9], [14, 19], [24, 29]]
    # Within a kind the order of the files stays, so that tests of a file meet what it has computed.
    assert [part == sorted(part[:2]) + sorted(part[2:]) for part in parts] == [True] * 3


def test_a_part_is_as_long_as_pytest_xdist_makes_it() -> None:
    slow = [number % 7 == 0 for number in range(100)]
    ordered = slow_first(range(100), slow, 3)
    starts = [ordered.index(number) for number in (0, 35, 70)]
    assert all(abs(start - length) <= 1 for start, length in zip(starts, (0, 33, 66), strict=True))


def test_one_process_keeps_slow_tests_first_too() -> None:
    assert slow_first("abc", [False, True, False], 1) == ["b", "a", "c"]
