"""The pictures of a report."""

import io
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import gymnasium as gym

from qtab.envs.origin.registered import what_changes_returns
from qtab.sweeps.results import Sweep
from qtab.sweeps.thresholds import environments, sweep_threshold

if TYPE_CHECKING:
    from qtab.planning import Optimum

MAX_SETTINGS = 8
"""The number of settings, best first, that the pictures show: as many as there are different colors."""


@dataclass(frozen=True)
class Picture:
    """A picture with its text alternative."""

    png: bytes
    alternative: str


def draw(sweep: Sweep) -> dict[str, Picture]:
    """Returns the pictures by name: final returns, learning curves, and the sensitivity to each parameter."""
    from qtab import plots

    ranking = [setting for setting in sweep.ranking() if len(sweep.values("final_return", setting))]
    best = ranking[:MAX_SETTINGS]
    shown = (
        f"the best {len(best)} of {len(sweep.settings)} settings"
        if len(best) < len(sweep.settings)
        else (f"all {len(best)} settings" if len(best) > 1 else "the setting")
    )
    threshold, optimum = sweep_threshold(sweep), _optimum(sweep)
    marked = False if threshold is None else threshold
    means = ", ".join(
        f"{_label(sweep, setting)}: mean {sweep.values('final_return', setting).mean():.4g}" for setting in best
    )
    axes = {
        "distribution": (
            plots.distribution(sweep, settings=best),
            f"Distribution of the final returns of {shown}. {means}.",
        ),
        "profile": (
            plots.profile(sweep, settings=best),
            f"Performance profile of {shown}: the proportion of runs whose final return exceeds each value.",
        ),
    }
    if any(sweep.curves(setting).size for setting in best):
        text = f"Learning curves of {shown}: the mean return of each {sweep.block} episodes."
        if threshold is not None:
            text += f" A line marks the reward threshold, {threshold:g}."
        if optimum is not None:
            text += f" A line marks the {optimum.label}, {optimum.expected_return:g}."
        curves = plots.learning_curves(sweep, block=sweep.block, settings=best, optimum=optimum, threshold=marked)
        axes["learning_curves"] = (curves, text)
    for parameter in sweep.settings[0]:
        values = sorted(set(sweep.columns[parameter].tolist()), key=str)
        if len(values) > 1:
            text = f"The final return over {parameter}, which takes the values {', '.join(map(str, values[:20]))}."
            axes[f"sensitivity_{parameter}"] = (plots.sensitivity(sweep, parameter), text)
    return {title: Picture(_png(ax), text) for title, (ax, text) in axes.items()}


def _label(sweep: Sweep, setting: int) -> str:
    rounded = {
        name: f"{value:.4g}" if isinstance(value, float) else value for name, value in sweep.settings[setting].items()
    }
    return ", ".join(f"{name} {value}" for name, value in rounded.items())


def _spec(sweep: Sweep) -> Any:
    """Returns the spec of the environment if it is registered. A store must not choose a module to import."""
    return gym.registry.get(sweep.env.rpartition(":")[2])


def _optimum(sweep: Sweep) -> "Optimum | None":
    """Returns the optimum of the environment; None if it is not known, was changed, or differs between settings."""
    from qtab.planning import optimum

    spec, found = _spec(sweep), environments(sweep)
    if spec is None or len(found) > 1:
        return None
    _, kwargs, max_episode_steps, description = found[0]
    if description is not None and what_changes_returns(description, spec, kwargs) is not None:
        return None
    with suppress(ValueError, TypeError, gym.error.Error):
        return optimum(spec, env_kwargs=kwargs, max_episode_steps=max_episode_steps)
    return None


def _png(ax: Any) -> bytes:
    buffer = io.BytesIO()
    ax.figure.savefig(buffer, format="png", dpi=120)
    return buffer.getvalue()
