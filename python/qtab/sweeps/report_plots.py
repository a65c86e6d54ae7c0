"""The pictures of a report."""

import io
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.sweeps.results import Sweep

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
    threshold, optimum = _threshold(sweep), _optimum(sweep)
    final_returns = {_label(sweep, setting): sweep.values("final_return", setting) for setting in best}
    means = ", ".join(f"{label}: mean {values.mean():.4g}" for label, values in final_returns.items())
    distribution = plots.distribution(final_returns)
    if threshold is not None:
        _mark(distribution, threshold, f"reward threshold {threshold:g}", is_vertical=True)
    axes = {
        "distribution": (distribution, f"Distribution of the final returns of {shown}. {means}."),
        "profile": (
            plots.profile(final_returns),
            f"Performance profile of {shown}: the proportion of runs whose final return exceeds each value.",
        ),
    }
    curves = None
    for index, setting in enumerate(best):
        if sweep.curves(setting).size:
            # The store has only the mean of each block; learning_curves averages the same blocks again.
            returns = np.repeat(sweep.curves(setting), sweep.block, axis=1)
            label = _label(sweep, setting)
            curves = plots.learning_curves(returns, curves, block=sweep.block, label=label, index=index)
    if curves is not None:
        text = f"Learning curves of {shown}: the mean return of each {sweep.block} episodes."
        for value, name in ((threshold, "reward threshold"), optimum):
            if value is not None:
                _mark(curves, value, f"{name} {value:g}")
                text += f" A line marks the {name}, {value:g}."
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


def _mark(ax: Any, value: float, label: str, is_vertical: bool = False) -> None:
    """Draws a dashed line at a return, and names it in the legend."""
    from qtab.plots.labels import add_legend

    line = ax.axvline if is_vertical else ax.axhline
    line(value, color="0.35", linewidth=1, linestyle=":" if "threshold" in label else "--", label=label, zorder=1)
    add_legend(ax)


def _spec(sweep: Sweep) -> Any:
    """Returns the spec of the environment if it is registered. A store must not choose a module to import."""
    return gym.registry.get(sweep.env.rpartition(":")[2])


def _threshold(sweep: Sweep) -> float | None:
    spec = _spec(sweep)
    return None if spec is None else spec.reward_threshold


def _optimum(sweep: Sweep) -> tuple[float | None, str]:
    """Returns the best known return of the environment and its name; None if settings differ in it."""
    from qtab.planning import optimum

    first = sweep.configs[0]
    spec = _spec(sweep)
    same = all(config[name] == first[name] for config in sweep.configs for name in ("env_kwargs", "max_episode_steps"))
    if spec is not None and same:
        with suppress(ValueError, TypeError, gym.error.Error):
            best = optimum(spec, env_kwargs=first["env_kwargs"], max_episode_steps=first["max_episode_steps"])
            return best.expected_return, best.label
    return None, ""


def _png(ax: Any) -> bytes:
    buffer = io.BytesIO()
    ax.figure.savefig(buffer, format="png", dpi=120)
    return buffer.getvalue()
