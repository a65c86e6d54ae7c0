"""Four pictures of a run in one figure, for a slide."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from qtab._utils import checks
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.parts.axes import shown_figure
from qtab.plots.parts.subject import subject_of
from qtab.plots.policy import policy
from qtab.plots.run import plot
from qtab.plots.schedule import schedule
from qtab.plots.values import values
from qtab.plots.visits import visits
from qtab.results.run import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from qtab.planning import Optimum


def overview(
    run: Run,
    *,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    optimum: "Optimum | float | None" = None,
) -> "Figure":
    """Draws four panels: the learning curve, the values, the policy, and the visits, or else the schedule.

    Args:
        run: The run. With ``visits=True`` the last panel shows its visits, otherwise the schedules of ε and α.
        at: For observations of more than two components, the values of those that are not axes; see
            :func:`qtab.plots.values`.
        layout: A map for numbered states; see :func:`qtab.plots.values`.
        optimum: A result of :func:`qtab.optimum`, or a return, to mark in the learning curve.

    Returns:
        The figure.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for one that does not fit the environment.
    """
    checks.instance("run", run, Run)
    figure = shown_figure(12, 7.5)
    (curve, value), (greedy, last) = figure.subplots(2, 2)
    plot(run, curve, optimum=optimum)
    drawn = subject_of("run", run).learned
    values(run, value, at=at, layout=layout, title="Preferences" if drawn == "preferences" else "Values")
    policy(run, greedy, at=at, layout=layout, title="Greedy policy")
    if run.visits is not None:
        visits(run, last, at=at, layout=layout, title="Visits")
    else:
        schedule(run, last, title="Schedule")
    return figure
