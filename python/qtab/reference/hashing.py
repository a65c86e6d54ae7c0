"""The hash that finds a row in a table with fewer rows than there are tiles."""

from collections.abc import Iterable

_MASK = 2**64 - 1


def hashed_row(numbers: Iterable[int], rows: int) -> int:
    """Returns the row, from 0 to ``rows`` - 1, of a tile: its tiling and its coordinates.

    Starting from 0, each number is added to the hash, which SplitMix64 then mixes (G. Steele, D. Lea and C. Flood,
    "Fast splittable pseudorandom number generators", 2014, with the constants of Vigna's version). The row is the upper
    half of the hash, as a fraction of the table.
    """
    word = 0
    for number in numbers:
        word = (word + number + 0x9E37_79B9_7F4A_7C15) & _MASK
        word = ((word ^ (word >> 30)) * 0xBF58_476D_1CE4_E5B9) & _MASK
        word = ((word ^ (word >> 27)) * 0x94D0_49BB_1331_11EB) & _MASK
        word ^= word >> 31
    return (word >> 32) * rows >> 32
