"""A picture of the learned values."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.parts.panels import arranged, draw_heat_maps
from qtab.plots.parts.subject import Drawable, Learned, Subject

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize

_LABELS: Mapping[Learned, str] = {
    "action values": "value, max$_a$ Q(s, a)",
    "state values": "value, v(s)",
    "preferences": "largest preference, max$_a$ H(s, a)",
}


@runtime_checkable
class Estimates(Protocol):
    """Values without actions: a :class:`qtab.ValueEstimates`."""

    def _subject(self) -> Subject:
        """Returns tables of one column."""


def values(
    run: Drawable | Estimates | Sequence[Drawable | Estimates],
    ax: "Axes | None" = None,
    *,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    title: str | None = None,
    step: int = 0,
    numbers: bool = True,
) -> "Axes":
    """Draws the value of each state: the largest action value, which is that of the greedy policy.

    For REINFORCE with baseline and actor-critic methods it is the learned state value, and for methods that learn only
    preferences it is the largest preference, as the color bar states.

    States are shown along the axes of the observation, or on the map of the environment; Taxi's by the place of the
    passenger and the destination, Blackjack's as in Sutton & Barto (2nd ed., Figure 5.2). The states of a table that
    :func:`qtab.tabulate` made are on a map of two of their components, one for each value of the others. Tile coding is
    sampled on 200 x 200 points. States in which nothing was learned are grey: never visited, if the run counted visits,
    and otherwise still at ``initial_q``, if that is one number. With tile coding this holds for most tiles of a grey
    point.

    Args:
        run: A run; the runs of many seeds with their tables, whose mean is shown; an optimum; or the result of
            :func:`qtab.estimate_values`. A sequence of them makes panels with one scale of colors; values of different
            discounts differ in size, so that each panel then has a separate scale.
        ax: The axes to draw on; None creates a new figure. A sequence needs None.
        at: For observations of more than two components, the values of those that are not axes, by the names in
            ``run.axes``, such as ``{"cart position": 0.0, "cart velocity": 0.0}``. Acrobot and Pendulum have angles
            instead of cosines and sines: ``"θ1"``, ``"θ2"``, ``"θ"``. Missing ones are 0, or the nearest possible.
        layout: A map for numbered states: rows of text as FrozenLake's ``desc``, with ``#`` for obstacles, or the
            numbers of rows and columns. None takes the environment's own.
        title: The title; None names the environment, the algorithm and the seed.
        step: The step of the episode to show, for runs with ``time_aware=True``.
        numbers: Whether to write the values into the cells of small maps.

    Returns:
        The axes; of several panels, those of the first.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for one that does not fit the environment, or runs without tables.
    """
    numbers = checks.boolean("numbers", numbers)
    given: list[Any] = list(run) if isinstance(run, list | tuple) else [run]
    sources: Any = [source._subject() if isinstance(source, Estimates) else source for source in given]
    panels = arranged(sources if isinstance(run, list | tuple) else sources[0], at, layout, title, step)
    label = value_label([subject for subject, _ in panels])
    grids = [subject.state_values(raster.rows) for subject, raster in panels]
    text = value_text if numbers else None
    one_scale = len({subject.discount for subject, _ in panels}) == 1
    return draw_heat_maps(panels, grids, ax, norm=common_norm, label=label, title=title, text=text, one_scale=one_scale)


def value_label(subjects: Sequence[Subject]) -> str:
    """Returns the label of the color bar of several subjects.

    Raises:
        ValueError: for both values and preferences, which have no common scale.
    """
    learned = {subject.learned for subject in subjects}
    if len(learned) == 1:
        return _LABELS[learned.pop()]
    if "preferences" in learned:
        raise ValueError("run must hold only runs that learned values or only runs that learned preferences, got both")
    return "value"


def common_norm(grids: Sequence[NDArray[np.float64]]) -> "Normalize":
    """Returns one scale of colors for the finite values of several pictures."""
    from matplotlib.colors import Normalize

    finite = np.concatenate([np.zeros(0), *(grid[np.isfinite(grid)] for grid in grids)])
    return Normalize(finite.min(), finite.max()) if len(finite) else Normalize(0, 1)


def value_text(value: float) -> str:
    """Returns the text of a value in a cell."""
    return f"{value:.3g}"
