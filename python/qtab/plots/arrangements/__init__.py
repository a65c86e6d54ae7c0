"""The positions of states in a picture: along the axes of the observation, on a map, or as in the book."""

from collections.abc import Mapping

import numpy as np

from qtab.plots.arrangements import blackjack
from qtab.plots.arrangements.grid_map import Layout, checked_layout, grid_map, known_layout
from qtab.plots.arrangements.plane import plane
from qtab.plots.arrangements.raster import Raster
from qtab.plots.arrangements.taxi import taxi
from qtab.plots.arrangements.tuples import tuples
from qtab.plots.parts.subject import Subject

__all__ = ["Raster", "arrange"]

TAXI_STATES = 500


def arrange(
    subject: Subject,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    sampled: bool = False,
) -> Raster:
    """Returns the raster for a picture of a subject.

    States whose names have components, such as those of a tabulated environment, are on a map of two of these.

    Args:
        subject: The subject to draw.
        at: The components of the observation that are held fixed, if it has more than two.
        layout: The map of an environment with numbered states; None takes the known one.
        sampled: Whether to sample points of a continuous space even if the table has cells.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for one that does not fit the environment.
    """
    shape = subject.discretizer.shape
    has_components = subject.discretizer.has_component_axes
    kind = subject.quantities.layout if has_components else ""  # other rows are not the states of a known map
    numbered = subject.discretizer.low.ndim == 0 and len(shape) == 1 and has_components
    if layout is not None and not numbered:
        raise ValueError(f"layout must be None for observations that are not numbered states, got {layout!r}")
    is_blackjack = kind == "blackjack" and shape == blackjack.SHAPE
    if at is not None and (numbered or is_blackjack):
        raise ValueError(f"at must be None for {subject.env}, whose picture shows every state, got {at!r}")
    if layout is None and kind == "map" and numbered:
        known = known_layout(subject)
        layout = known if sum(map(len, known)) == shape[0] else None
    if layout is not None:
        return grid_map(checked_layout(layout, shape[0]), int(np.ravel(subject.discretizer.low)[0]))
    if is_blackjack:
        return blackjack.blackjack()
    if kind == "taxi" and shape == (TAXI_STATES,):
        return taxi()
    [names] = [axis.values for axis in subject.axes] if numbered else [()]
    by_name = tuples(names) if len(names) == shape[0] else None
    return by_name or plane(subject, at, sampled)
