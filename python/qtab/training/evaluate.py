"""``qtab.evaluate``: measures the greedy policy of a run."""

from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from qtab._utils import checks, html
from qtab._utils.checks import required
from qtab._utils.data_frames import episode_frame
from qtab._utils.fields import with_fields
from qtab._utils.progress import check_progress
from qtab._utils.shown import counted, shown
from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.config.merge import over
from qtab.config.unknown import suggesting
from qtab.discretizers.assigned_rows import AssignedRows
from qtab.envs.in_rust.matching import time_limit
from qtab.envs.metadata.goals import threshold_of
from qtab.envs.registry import make_env, spec_of, spec_of_run
from qtab.results.action_values import greedy_table
from qtab.results.run import Run
from qtab.training.callbacks import TrainingOptions
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import log_python_stepping
from qtab.training.setup.run_env import check_env, check_spaces, resolve_run
from qtab.training.train import train_resolved

if TYPE_CHECKING:
    import pandas as pd

GREEDY: Mapping[str, Any] = {
    "algorithm": "q_learning",
    "learning_rate": 0.0,
    "learning_rate_schedule": "constant",
    "count_bonus": 0.0,
    "terminal_update": "target",
    "exploration": "epsilon_greedy",
    "epsilon": 0.0,
    "epsilon_schedule": "constant",
    "ties": "first",
}
"""Settings with which training becomes evaluation: no learning, and ties go to the first greedy action."""


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class Evaluation:
    """Episodes played by a greedy policy, without learning."""

    returns: NDArray[np.float64]
    """(episodes,): the sum of rewards of each episode."""
    lengths: NDArray[np.int64]
    """(episodes,): the number of steps of each episode."""
    terminated: NDArray[np.bool_]
    """(episodes,): whether each episode ended in a terminal state."""
    seed: int
    """The seed of the environment."""
    reward_threshold: float | None
    """The return at which Gymnasium considers the environment solved; None if Gymnasium defines none for this time
    limit and these keyword arguments."""

    def __repr__(self) -> str:
        return f"<Evaluation of {self._episodes}: mean return {self._mean}, seed {self.seed}>"

    @property
    def _episodes(self) -> str:
        return counted(len(self.returns), "episode")

    @property
    def _mean(self) -> str:
        error = f" ± {self.standard_error:.2f}" if len(self.returns) > 1 else ""
        return f"{self.mean_return:.2f}{error}"

    def _repr_html_(self) -> str:
        """Returns a table and a histogram of the returns, for notebooks."""
        facts: dict[str, object] = {
            "mean return": self._mean + (" (standard error)" if len(self.returns) > 1 else ""),
            "returns": f"{self.returns.min():.6g} to {self.returns.max():.6g}",
            "mean length": f"{self.lengths.mean():.6g} steps",
            "terminated": f"{self.terminated_rate:.1%}",
        }
        if self.success_rate is not None:
            facts["success"] = f"{self.success_rate:.1%} at or above {self.reward_threshold:g}"
        picture = ""
        if np.isfinite(self.returns).all() and self.returns.min() < self.returns.max():
            counts, edges = np.histogram(self.returns, bins=min(30, len(self.returns)))
            picture = html.bars("Histogram of the returns", counts, f"{edges[0]:.4g}", f"{edges[-1]:.4g}")
        return html.summary(f"Evaluation of {self._episodes}, seed {self.seed}", facts, picture)

    def to_pandas(self) -> "pd.DataFrame":
        """Returns a data frame with one row per episode: its number, its return, its length and how it ended.

        Raises:
            ModuleNotFoundError: without pandas; the message names the ``pip install``.
        """
        return episode_frame(self.returns, self.lengths, self.terminated)

    @property
    def mean_return(self) -> float:
        """The average return."""
        return float(np.mean(self.returns))

    @property
    def standard_error(self) -> float:
        """The standard error of the average return; NaN for a single episode."""
        count = len(self.returns)
        return float(np.std(self.returns, ddof=1) / np.sqrt(count)) if count > 1 else float("nan")

    @property
    def terminated_rate(self) -> float:
        """The fraction of episodes that ended in a terminal state."""
        return float(np.mean(self.terminated))

    @property
    def success_rate(self) -> float | None:
        """The fraction of returns at or above the threshold; None where there is none."""
        return None if self.reward_threshold is None else float(np.mean(self.returns >= self.reward_threshold))


@suggesting
def evaluate(
    run: Run,
    episodes: int = 100,
    seed: int | None = None,
    env: str | EnvSpec | gym.Env | None = None,
    *,
    env_kwargs: Mapping[str, Any] | None = None,
    max_episode_steps: int | None = None,
    progress: bool | None = None,
) -> Evaluation:
    """Plays episodes with a run's greedy policy, without exploration or learning.

    Ties go to the first of the greedy actions.

    Args:
        run: The run to evaluate.
        episodes: The number of episodes.
        seed: The seed of the environment; None draws one, which the evaluation records.
        env: A different environment, or a copy of the run's if qtab cannot make it again: an id, an EnvSpec, or an
            environment, which is not closed. None makes the environment that the run was trained on, with its
            wrappers and changed attributes.
        env_kwargs: Keyword arguments for the environment's constructor; None takes those of the run, or none if
            ``env`` is given.
        max_episode_steps: The time limit of an episode, in steps; None takes that of the run.
        progress: Whether to show a progress bar. None shows one on a terminal or in a notebook if the episodes take
            more than a second.

    Raises:
        gymnasium.error.UnregisteredEnv: without ``env``, for a run whose environment is not registered.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, an environment whose spaces differ from the run's, or, without
            ``env``, an environment that cannot be made again as it was in training; the message gives the reason.
    """
    checks.instance("run", run, Run)
    check_progress(progress)
    check_env(env)
    config = run.config
    if config.time_aware and max_episode_steps not in (None, config.max_episode_steps):
        raise ValueError(
            f"max_episode_steps must be {config.max_episode_steps} for a run with time_aware=True, whose policy "
            f"depends on its time limit, got {shown(max_episode_steps)}"
        )
    if env is None:
        spec_of_run(config.env)
    elif isinstance(env, gym.Env):
        check_spaces(run, env)
        limit = time_limit(env)
        if config.time_aware and limit is not None and limit < required("max_episode_steps", config.max_episode_steps):
            raise ValueError(
                f"env must have a time limit of at least {config.max_episode_steps} steps, as in the run with "
                f"time_aware=True, got {limit}"
            )
    else:
        spec = env if isinstance(env, EnvSpec) else spec_of(env)
        with closing(make_env(spec, env_kwargs or {})) as made:
            check_spaces(run, made)
    is_derived = config.origin is not None and "backend" in config.origin.derived
    # Start from the run's settings, so that no preset adds any.
    settings = over(
        config,
        {
            **GREEDY,
            "episodes": episodes,
            "seed": seed,
            "initial_q": 0.0 if isinstance(run.discretizer, AssignedRows) else greedy_table(run),
            "env_kwargs": _env_kwargs(config, env, env_kwargs),
            "preset": config.preset if env is None else None,
            "max_episode_steps": config.max_episode_steps if max_episode_steps is None else max_episode_steps,
            "backend": "auto" if env is not None or env_kwargs is not None or is_derived else config.backend,
        },
    )
    resolved = resolve_run(config, settings) if env is None else resolve(env, settings)
    if isinstance(run.discretizer, AssignedRows):
        played_on = replace_checked(resolved.config, initial_q=greedy_table(run))
        resolved = replace(resolved, discretizer=run.discretizer.as_played(), config=played_on)
    if env is not None:
        log_python_stepping(resolved)
    try:
        played = train_resolved(resolved, TrainingOptions(progress=progress))
    finally:
        resolved.close()
    return Evaluation(
        played.episode_returns,
        played.episode_lengths,
        played.terminated,
        resolved.seed,
        threshold_of(resolved.config),
    )


def _env_kwargs(config: Config, env: Any, env_kwargs: Mapping[str, Any] | None) -> Mapping[str, Any]:
    if env_kwargs is not None:
        return env_kwargs
    if env is None:
        return config.env_kwargs
    return dict(env.kwargs) if isinstance(env, EnvSpec) else {}
