"""A picture of greedy episodes over the learned values: for a continuous state, the phase portrait."""

from collections.abc import Mapping
from contextlib import nullcontext
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.planning.optimum import Optimum
from qtab.plots.arrangements import Raster, arrange
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.parts.labels import check_title
from qtab.plots.parts.subject import subject_of
from qtab.plots.values import values
from qtab.results.action_values import mask_of_step
from qtab.results.run import Run
from qtab.training.setup.run_env import make_run_env

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def trajectory(
    run: Run | Optimum,
    ax: "Axes | None" = None,
    *,
    episodes: int = 3,
    seed: int = 0,
    env: gym.Env | None = None,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    title: str | None = None,
) -> "Axes":
    """Draws episodes of the greedy policy over the values of the states.

    A circle marks the beginning of an episode, a star a terminal state, a cross the time limit. If the observation
    has more than two components, the values are those of the slice that ``at`` names, and the episodes are projected.

    Args:
        run: The run, or the optimum.
        ax: The axes to draw on; None creates a new figure.
        episodes: The number of episodes.
        seed: The seed of the first reset of the environment.
        env: The environment, if that of the run cannot be made again; it is not closed.
        at: For observations of more than two components, the values of those that are not axes; see
            :func:`qtab.plots.values`.
        layout: A map for numbered states; see :func:`qtab.plots.values`.
        title: The title; None names the environment, the algorithm and the seed.

    Returns:
        The axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or one that does not fit the environment.
    """
    if not isinstance(run, Run | Optimum):
        raise TypeError(f"run must be a Run or an Optimum, got {run!r}")
    episodes = checks.integer("episodes", episodes, least=1)
    seed = checks.integer("seed", seed, least=0)
    check_title(title)
    subject = subject_of("run", run)
    raster = arrange(subject, at, layout)
    played = [
        (np.array([subject.discretizer.along_axes(one) for one in observations]), terminated)
        for observations, terminated in _play(run, env, episodes, seed)
    ]
    ax = values(run, ax, at=at, layout=layout, title=title, numbers=False)
    for index, (observations, terminated) in enumerate(played):
        _draw_path(ax, raster, observations, terminated, index, episodes)
    return ax


def _play(run: Run | Optimum, env: gym.Env | None, episodes: int, seed: int) -> list[tuple[list[Any], bool]]:
    """Returns the observations of each episode, and whether it ended in a terminal state."""
    if env is not None and not isinstance(env, gym.Env):
        raise TypeError(f"env must be an environment, got {env!r}")
    config = run.config
    if env is None:
        try:
            made: Any = make_run_env(config, of="gymnasium")
        except gym.error.Error:
            raise ValueError(
                f"env must be given: {config.env!r}, the run's environment, is not a registered id"
            ) from None
    else:
        made = nullcontext(gym.wrappers.TimeLimit(env, checks.required("max_episode_steps", config.max_episode_steps)))
    played = []
    with made as playing:
        for index in range(episodes):
            observation, info = playing.reset(seed=seed if index == 0 else None)
            observations, over, terminated, state = [observation], False, False, None
            while not over:
                if isinstance(run, Run):
                    mask = mask_of_step(run.config, playing, observation, info)
                    action, state = run.predict(observation, state, action_masks=mask)
                else:
                    action, state = run.predict(observation, state)
                observation, _, terminated, truncated, info = playing.step(action)
                observations.append(observation)
                over = bool(terminated or truncated)
            played.append((observations, bool(terminated)))
    return played


def _draw_path(
    ax: "Axes", raster: Raster, observations: NDArray[Any], terminated: bool, index: int, episodes: int
) -> None:
    points = raster.locate(observations)
    if raster.is_map:
        # Side by side, so that episodes along the same cells can be told apart.
        points = points + 0.36 * ((index + 0.5) / episodes - 0.5)
    low, high = (np.array([raster.x_edges[end], raster.y_edges[end]]) for end in (0, -1))
    middle = np.clip(points, low, high)
    path = _broken(middle, raster)
    width = 1.2 if len(path) < 250 else 0.7
    ax.plot(*path.T, color="#101010", linewidth=width + 1.3, solid_joinstyle="round", zorder=8)
    ax.plot(*path.T, color="#ffffff", linewidth=width, solid_joinstyle="round", zorder=8)
    marks: dict[str, Any] = {"linestyle": "none", "markeredgecolor": "#101010", "zorder": 9}
    ax.plot(*middle[0], marker="o", markersize=6, markerfacecolor="#ffffff", **marks)
    end: dict[str, Any] = {"marker": "*", "markersize": 13} if terminated else {"marker": "X", "markersize": 8}
    ax.plot(*middle[-1], markerfacecolor="#ff8a3d", **end, **marks)


def _broken(points: NDArray[np.float64], raster: Raster) -> NDArray[np.float64]:
    """Returns a path with NaN where it jumps: from map to map, or where an angle passes from π to -π."""
    spans = np.array([np.ptp(raster.x_edges), np.ptp(raster.y_edges)])
    limit = np.full(2, 1.5) if raster.has_gaps else spans / 2
    jumps = np.flatnonzero((np.abs(np.diff(points, axis=0)) > limit).any(axis=1)) + 1
    return np.insert(points, jumps, np.nan, axis=0)
