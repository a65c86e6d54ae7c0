"""The picture of estimated values."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from qtab.envs.metadata.quantities import observation_quantities, observed_quantities, quantities_of
from qtab.plots.parts.axes import axes_or_new
from qtab.plots.parts.labels import finish
from qtab.plots.parts.subject import Subject

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.prediction.estimates import ValueEstimates


def subject_of_values(estimates: "ValueEstimates") -> Subject:
    """Returns the subject of a picture of estimated values: tables with a single column, which stands for no action.

    Raises:
        ValueError: for estimates from a file that does not include the discretizer.
    """
    discretizer = estimates.discretizer
    if discretizer is None:
        raise ValueError("run must be estimates with their discretizer, got those of numbered states from a file")
    settings, count = estimates.settings, len(estimates.seeds)
    of_cells = estimates.of_cells
    values = estimates.values.reshape(count, -1) if of_cells else estimates.weights[:, -1]
    initial = settings.initial_value / (1 if of_cells else estimates.n_active)
    env_kwargs = {} if estimates.config is None else estimates.config.env_kwargs
    which = "1 seed" if count == 1 else f"{count:,} seeds"
    name = f"{estimates.env}: values by {settings.method}, {which}"
    # With weighted features every value has a meaning.
    known = None if estimates.is_weighted else values != initial
    return Subject(
        estimates,
        estimates.env,
        env_kwargs,
        observed_quantities(estimates.env, discretizer.low, discretizer.high),
        name,
        discretizer,
        values[..., np.newaxis],
        known,
        ("",),
        settings.discount,
        "state values",
    )


def draw_values(estimates: "ValueEstimates", ax: "Axes | None", true_values: NDArray[np.float64] | None) -> "Axes":
    """Draws the mean values over the states; see :meth:`qtab.ValueEstimates.plot`."""
    ax = axes_or_new(ax)
    title = f"{estimates.env}: values by {estimates.settings.method}"
    mean = estimates.mean
    if mean.ndim == 1:
        states = np.arange(len(mean))
        error = 2 * np.nan_to_num(estimates.standard_error)
        (line,) = ax.plot(
            states, mean, linewidth=1.6, marker="o" if len(mean) <= 40 else "", markersize=4, label="mean"
        )
        ax.fill_between(states, mean - error, mean + error, color=line.get_color(), alpha=0.25, linewidth=0)
        if true_values is not None:
            ax.plot(states, true_values, color="0.5", linestyle="--", linewidth=1.2, label="true values")
        return finish(ax, "state", "value", title)
    first, second, *others = observation_quantities(quantities_of(estimates.env), mean.ndim)
    notes: list[str] = []
    for known in reversed(others):
        middle = mean.shape[-1] // 2
        notes.insert(0, f"{known.name} = {known.values[middle] if known.values else middle}")
        mean = mean[..., middle]
    image = ax.imshow(mean, aspect="auto", origin="lower")
    ax.figure.colorbar(image, ax=ax, label="value")
    ax.set(xlabel=second.name, ylabel=first.name, title=", ".join([title, *notes]))
    return ax
