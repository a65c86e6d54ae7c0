"""Performance profiles (Agarwal et al., 2021)."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import arrays, checks
from qtab.plots.parts.axes import axes_or_new, check_axes
from qtab.plots.parts.colors import line_style, palette
from qtab.plots.parts.inputs import color_keys, entries, final_returns
from qtab.plots.parts.labels import finish, joined
from qtab.results.run import Run
from qtab.results.runs import Runs
from qtab.sweeps.results import Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEVELS = 200
"""The number of thresholds if none are given."""

Environments = dict[str, NDArray[np.float64]]
"""The scores of one setting on each environment, (runs,) each."""


def profile(
    scores: Any,
    ax: "Axes | None" = None,
    *,
    thresholds: ArrayLike | None = None,
    confidence: float = 0.95,
    settings: Sequence[int] | None = None,
    colors: Any = None,
    title: str = "",
) -> "Axes":
    """Draws, for each setting, the proportion of runs that score above each threshold. Higher curves are better.

    The bands are the intervals of :func:`qtab.stats.profile`. A setting with a single run on some environment has none.

    Args:
        scores: A Run, Runs, a Sweep, an array (runs,) or (runs, environments); or a mapping of names to any of these
            or to a mapping of environments to Runs or (runs,). Scores of Run, Runs and Sweep are their final returns.
            A sweep has a curve for each setting; of more than eight settings, the eight with the best mean final
            return, which the legend reports.
        ax: The axes to draw on; None creates a new figure, which a notebook and ``plt.show()`` show.
        thresholds: (thresholds,) float; None spans all scores.
        confidence: The coverage probability of the interval at each threshold, between 0 and 1.
        settings: The indices of the settings of a sweep to draw, such as ``[0, 3]``.
        colors: A color, a sequence of colors, or a mapping of names to colors; None chooses.
        title: The title of the axes.

    Raises:
        ModuleNotFoundError: without matplotlib or SciPy; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for scores of another shape, empty data, or scores that are not finite.
    """
    from qtab import stats
    from qtab.stats.bootstrap import as_confidence

    check_axes(ax)
    checks.instance("title", title, str)
    confidence = as_confidence(confidence)
    labels, keys, environments, note = _by_setting(scores, settings)
    pooled = np.concatenate([runs for setting in environments for runs in setting.values()])
    if thresholds is None:
        margin = np.ptp(pooled) / 50 or 1.0  # all runs are above the lowest threshold
        levels = np.linspace(pooled.min() - margin, pooled.max() + margin, LEVELS)
    else:
        levels = np.sort(arrays.sample("thresholds", thresholds))
    # The numbers come before the figure, so that an error leaves no empty figure.
    bands = [
        stats.profile(setting, levels, confidence=confidence) if min(map(len, setting.values())) > 1 else None
        for setting in environments
    ]
    ax = axes_or_new(ax)
    hues = palette(keys, ax, None, colors, labels)
    has_band = False
    for index, (label, setting, band, hue) in enumerate(zip(labels, environments, bands, hues, strict=True)):
        proportions = stats.performance_profile(setting, levels)
        counts = sorted({len(runs) for runs in setting.values()})
        runs = f"{'-'.join(map(str, dict.fromkeys((counts[0], counts[-1]))))} run{'' if counts[-1] == 1 else 's'}"
        style: dict[str, Any] = {"color": hue, "linewidth": 2, "linestyle": line_style(index)}
        ax.step(levels, proportions, where="post", label=label or runs, **style)
        if band is not None:
            has_band = True
            low, high = [point.low for point in band], [point.high for point in band]
            ax.fill_between(levels, low, high, step="post", color=hue, alpha=0.28, linewidth=0)
    ax.set_ylim(-0.02, 1.02, auto=True)
    ax.set_yticks(np.linspace(0, 1, 6))
    ax.yaxis.set_major_formatter("{x:.0%}")
    if has_band:
        note = joined(note, f"{100 * confidence:.4g}% intervals")
    return finish(ax, "score τ", "proportion of runs with a score above τ", title, legend_title=note)


def _by_setting(scores: Any, settings: Sequence[int] | None) -> tuple[list[str], list[Any], list[Environments], str]:
    """Returns the labels, the keys of the colors, the scores by environment, and a note, see ``entries``."""
    named: Mapping[Any, Any] = scores if isinstance(scores, Mapping) else {"": scores}
    if any(isinstance(value, Mapping) or _is_table(value) for value in named.values()):
        labels = [str(name) for name in named]
        arguments = [f"scores[{name!r}]" for name in named] if isinstance(scores, Mapping) else ["scores"]
        return labels, labels, list(map(_by_environment, arguments, named.values())), ""
    drawn, note = entries("scores", scores, "final returns", settings)
    return [entry.label for entry in drawn], color_keys(drawn), [{"": entry.values} for entry in drawn], note


def _is_table(value: Any) -> bool:
    return not isinstance(value, Run | Runs | Sweep | str) and hasattr(value, "__len__") and arrays.is_table(value)


def _by_environment(argument: str, value: Any) -> Environments:
    if isinstance(value, Mapping):
        if not value:
            raise ValueError(f"{argument} must hold at least one environment, got {value!r}")
        return {str(name): final_returns(f"{argument}[{name!r}]", runs) for name, runs in value.items()}
    if isinstance(value, Run | Runs):
        return {"": final_returns(argument, value)}
    if isinstance(value, Sweep):
        raise TypeError(f"{argument} must be Runs or arrays beside settings on several environments, got {value!r}")
    array = arrays.numbers(argument, value)
    if array.ndim not in (1, 2) or not array.size:
        raise ValueError(f"{argument} must have the shape (runs,) or (runs, environments), got {array.shape}")
    return {str(index): column for index, column in enumerate(array.reshape(len(array), -1).T)}
