"""The HTML page of a run."""

import dataclasses
import os
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils import checks
from qtab._utils.files import check_writable, replacing
from qtab._utils.page import page, paragraph, picture, section, table
from qtab._utils.shown import counted, last_of, shown
from qtab.config import Config
from qtab.config.choices import ALGORITHM_NAMES, IN_PYTHON
from qtab.diagnosis.diagnose import diagnose
from qtab.diagnosis.diagnosis import Diagnosis
from qtab.envs.metadata.goals import threshold_of
from qtab.planning.optimum import Optimum
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.parts.axes import new_figure, png
from qtab.plots.run import plot
from qtab.rendering.agent import agent_of
from qtab.rendering.film import Film
from qtab.rendering.formats import png_uris
from qtab.rendering.learning import PANELS, draw_learning, runs_at_snapshots
from qtab.rendering.player import episode_player, slider
from qtab.results.run import Run
from qtab.results.summary import FINAL_EPISODES
from qtab.training.setup.run_env import check_env

MAX_SNAPSHOTS = 50
"""The largest number of snapshots to show."""
MAX_FRAMES = 300
"""The largest number of frames; longer episodes are cut, so that the page stays small."""
DOTS_PER_INCH = 100
SNAPSHOTS_PER_SECOND = 5.0


def write_page(
    run: Run,
    path: "str | os.PathLike[str]",
    *,
    optimum: Optimum | float | None = None,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    env: Any = None,
    progress: bool | None = None,
) -> None:
    """Writes the page; see :meth:`qtab.Run.to_html` for the arguments and the errors."""
    target = checks.file_path("path", path)
    check_env(env)
    check_writable("path", target)
    episode = _episode(run, env)  # first, so that a wrong environment raises at once
    found = _diagnosis(run, optimum)
    if optimum is None and found is not None:
        optimum = _best_known(found)
    parts = [
        table((), _summary(run)),
        section("Learning curve", _learning_curve(run, optimum)),
        section("What it learned", _learned(run, at, layout, progress)),
        section("A greedy episode", episode),
        section("Diagnosis", _findings(found)),
        section("Settings", table((), _settings(run.config))),
        section("How it was made", table((), [*run.versions.items(), ("training", f"{run.seconds:.3g} s")])),
    ]
    with replacing(target) as temporary:
        temporary.write_text(page(run.config.env, "\n".join(parts)), encoding="utf-8")


def _summary(run: Run) -> list[tuple[str, Any]]:
    returns = run.episode_returns
    finished = f"{len(returns):,}" + ("" if run.completed else f" of {run.config.episodes:,}")
    rows: list[tuple[str, Any]] = [
        ("algorithm", ALGORITHM_NAMES[run.config.algorithm]),
        ("seed", run.config.seed),
        ("episodes", f"{finished}, {int(run.episode_lengths.sum()):,} steps"),
        ("table", " × ".join(f"{size:,}" for size in run.tables.shape)),
    ]
    if len(returns):
        last = returns[-FINAL_EPISODES:]
        rows.append((f"mean return of the {last_of(len(last), 'episode')}", f"{last.mean():.2f}"))
        rows.append(("best return", f"{returns.max():.6g}"))
    threshold = threshold_of(run.config)
    if threshold is not None:
        rows.append(("threshold", f"{threshold:g}"))
    return rows


def _learning_curve(run: Run, optimum: Optimum | float | None) -> str:
    figure = new_figure()
    plot(run, figure.subplots(), optimum=optimum)
    returns, text = run.episode_returns, "no episode was finished"
    if len(returns):
        count = min(FINAL_EPISODES, len(returns))
        text = f"the first {count} have a mean of {returns[:count].mean():.2f}, the last {returns[-count:].mean():.2f}"
    return picture(
        png(figure, DOTS_PER_INCH), f"Learning curve, the returns of {counted(len(returns), 'episode')}: {text}."
    )


def _learned(run: Run, at: Mapping[str, float] | None, layout: Layout | None, progress: bool | None) -> str:
    states, finished = [(len(run.episode_returns), run)], len(run.episode_returns)
    if run.snapshots is not None and len(run.snapshots):
        at_snapshots = [state for state in runs_at_snapshots(run) if state[0] != finished]
        chosen = np.unique(np.linspace(0, len(at_snapshots) - 1, min(len(at_snapshots), MAX_SNAPSHOTS - 1)).astype(int))
        states = [*(at_snapshots[index] for index in chosen), *states]
    titles = "Values", "Greedy policy"
    frames = draw_learning(states, PANELS, SNAPSHOTS_PER_SECOND, at, layout, titles, progress)
    title = f"Values of the states and greedy policy of {run.config.env}"
    return slider(list(png_uris(frames)), frames.labels, frames.fps, title)


def _episode(run: Run, env: Any) -> str:
    limit, seed = int(run.config.max_episode_steps or 1), int(run.config.seed or 0)
    film = Film(agent_of(run), env, None, limit, 1, seed, None, MAX_FRAMES)
    try:
        played, frames = film.record(), film.frames()
    except (gym.error.Error, ModuleNotFoundError, TypeError, ValueError) as error:
        if env is not None:
            raise
        return paragraph(f"There is no video: {error}.")
    result = f"Its first {len(frames) - 1} steps."
    if len(played.returns):
        result = f"Return {played.returns[0]:.6g} in {played.lengths[0]:,} steps, without exploration, seed {seed}."
    return paragraph(result) + episode_player(frames, f"Greedy episode in {run.config.env}")


def _diagnosis(run: Run, optimum: Optimum | float | None) -> Diagnosis | None:
    """Returns the diagnosis if it takes about a second and the run has rows that it can read, else None."""
    if run.config.backend in IN_PYTHON or not len(run.episode_returns) or run.discretizer.is_weighted:
        return None
    return diagnose(run, optimum if isinstance(optimum, Optimum) else None)


def _best_known(found: Diagnosis) -> Any:
    """Returns the mark of the learning curve: the exact optimum, or the best known return with its name."""
    value = found.facts.best_return
    if found.facts.optimum is not None or value is None:
        return found.facts.optimum
    return SimpleNamespace(expected_return=value, label="best known")


def _findings(found: Diagnosis | None) -> str:
    if found is None:
        return paragraph(
            "Not available: the diagnosis needs an environment that Rust steps, a finished episode, and a discretizer "
            "without weighted features."
        )
    return f'<div class="text wide">{found._repr_html_()}</div>'


def _settings(config: Config) -> list[tuple[str, str]]:
    given = {one.name: getattr(config, one.name) for one in dataclasses.fields(config)}
    empty = [
        name for name, value in given.items() if value is None or (isinstance(value, Mapping | tuple) and not value)
    ]
    return [(name, _setting(value)) for name, value in given.items() if name not in empty]


def _setting(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"array of shape {value.shape}"
    return value if isinstance(value, str) else shown(value)
