"""The number of episodes that a point of a learning curve averages."""

import math
from collections.abc import Sequence

from qtab._utils import checks
from qtab.results.summary import default_block

_SHORT_BLOCKS = (50, 20, 10, 5, 2)
_MIN_POINTS = 20


def fitting_block(episodes: int) -> int:
    """Returns the default number of episodes in a block: 100, and more for runs of more than 10,000 episodes.

    Runs of fewer than 2,000 episodes have at least twenty shorter blocks, and those of fewer than forty have blocks of
    one.
    """
    if episodes >= _MIN_POINTS * 100:
        return default_block(episodes)
    return next((block for block in _SHORT_BLOCKS if episodes >= _MIN_POINTS * block), 1)


def common_block(block: int | None, lengths: Sequence[int], units: Sequence[int]) -> int:
    """Returns the number of episodes in a block of several learning curves.

    Args:
        block: The user's choice; None fits the block to the shortest curve.
        lengths: The number of episodes of each curve.
        units: The number of episodes that each point of a curve already averages.

    Raises:
        TypeError: if ``block`` is not an integer.
        ValueError: if it is longer than a curve, or not a multiple of a unit; without it, if no block fits all curves.
    """
    shortest, unit = min(lengths), math.lcm(*units)
    if block is None:
        if unit > shortest:
            raise ValueError(
                f"returns must have at least {unit:,} episodes, the block of the sweep that is drawn with them, "
                f"got {shortest:,}"
            )
        rounded = math.ceil(fitting_block(shortest) / unit) * unit
        return rounded if rounded <= shortest else unit
    block = checks.integer("block", block, least=1, most=shortest)
    if block % unit:
        raise ValueError(f"block must be a multiple of the sweep's block, {unit:,}, got {block:,}")
    return block
