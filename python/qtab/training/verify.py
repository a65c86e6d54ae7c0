"""Proof that the fast run computed what the slow one computes."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab._utils import checks
from qtab._utils.versions import versions
from qtab.config import Config
from qtab.envs.registry import ENTRIES, gymnasium_id
from qtab.reference import LEARNERS
from qtab.results.run import Run
from qtab.training.resolve import resolve


@dataclass(frozen=True)
class Verification:
    """What a comparison with Gymnasium and NumPy found."""

    env: str
    seed: int
    episodes: int
    """How many episodes were compared."""
    returns_equal: bool
    lengths_equal: bool
    table_equal: bool
    episode: int | None
    """The first episode (from 0) in which the two sides part; None where they do not."""
    step: int | None
    """The first step (from 0) of that episode at which they part; None where its steps are equal."""
    versions: dict[str, str]

    @property
    def equal(self) -> bool:
        """Whether returns, lengths and the Q table are equal byte for byte."""
        return self.returns_equal and self.lengths_equal and self.table_equal

    def __str__(self) -> str:
        """A report for a person."""

        def word(equal: bool) -> str:
            return "equal" if equal else "DIFFERENT"

        lines = [
            f"{self.env}, seed {self.seed}, {self.episodes} episodes against Gymnasium and NumPy, byte for byte",
            f"  returns  {word(self.returns_equal)}",
            f"  lengths  {word(self.lengths_equal)}",
            f"  Q table  {word(self.table_equal)}",
        ]
        if self.episode is not None:
            where = "" if self.step is None else f", step {self.step}"
            lines.append(f"  they part in episode {self.episode}{where} (counted from 0)")
        lines.append("  " + ", ".join(f"{name} {value}" for name, value in self.versions.items()))
        return "\n".join(lines)


def verify(
    run: Run,
    episodes: int | None = None,
    env: gym.Env | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Verification:
    """Replays a run's config through real Gymnasium and the reference loop in plain NumPy.

    Args:
        run: What to verify.
        episodes: Compare this many episodes of the full run's schedule: both sides run again, and their tables after
            that many are compared. None compares the run as it is, its Q table included.
        env: The environment, for a run that was trained on an object that no id names.
        progress: Called after every episode of the reference loop with the number done and the total.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or a run that was interrupted and so has no table to compare.
    """
    checks.instance("run", run, Run)
    finished = len(run.episode_returns)
    if episodes is None and not run.completed:
        raise ValueError(f"episodes must be given for a run that was stopped early, at most {finished}")
    count = checks.integer("episodes", finished if episodes is None else episodes, least=1, most=finished)
    config = run.config
    assert config.seed is not None  # noqa: S101 - a run's config is resolved

    watched = _Watched(_environment(config, env), count, progress)
    try:
        table, returns, lengths = LEARNERS[config.algorithm](watched, config, stop_after=count)
        if progress is not None:
            progress(count, count)
    finally:
        if env is None:
            watched.close()

    ours = run.tables if episodes is None else _again(config, env, count)[0]
    episode = _first_difference(returns, lengths, run.episode_returns[:count], run.episode_lengths[:count])
    return Verification(
        env=config.env,
        seed=config.seed,
        episodes=count,
        returns_equal=returns.tobytes() == run.episode_returns[:count].tobytes(),
        lengths_equal=lengths.tobytes() == run.episode_lengths[:count].tobytes(),
        table_equal=table.tobytes() == ours.tobytes(),
        episode=episode,
        step=None if episode is None else _first_step(config, env, run, watched, episode),
        versions=versions(),
    )


def _environment(config: Config, env: gym.Env | None) -> gym.Env:
    """Gymnasium's own environment, even for an id of ours."""
    if env is not None:
        assert config.max_episode_steps is not None  # noqa: S101 - resolved
        return gym.wrappers.TimeLimit(env, config.max_episode_steps)
    name = gymnasium_id(config.env)
    return gym.make(
        name if name in ENTRIES else config.env, max_episode_steps=config.max_episode_steps, **config.env_kwargs
    )


def _again(config: Config, env: gym.Env | None, episodes: int) -> tuple[NDArray[np.float64], list[Any]]:
    """The fast side once more: its table after so many episodes, and the actions of the last of them."""
    resolved = resolve(config.env if env is None else env, _fields(config))
    try:
        trainer = _core.Trainer(resolved.spec(), resolved.seed, record=1)
        trainer.advance(episodes)
        (_, actions) = trainer.recordings()[-1]
        return trainer.tables(), [resolved.grid.choices[action] for action in actions]
    finally:
        resolved.close()


def _fields(config: Config) -> dict[str, Any]:
    return {name: value for name, value in vars(config).items() if name != "env"}


def _first_difference(*columns: NDArray[Any]) -> int | None:
    half = len(columns) // 2
    unequal = np.zeros(len(columns[0]), dtype=bool)
    for theirs, ours in zip(columns[:half], columns[half:], strict=True):
        unequal |= theirs != ours
    return int(np.argmax(unequal)) if unequal.any() else None


def _first_step(config: Config, env: gym.Env | None, run: Run, watched: "_Watched", episode: int) -> int | None:
    theirs = watched.actions[episode]
    _, ours = _again(config, env, episode + 1)
    for step, (one, other) in enumerate(zip(theirs, ours, strict=False)):
        if not np.array_equal(one, other):
            return step
    shortest = min(len(theirs), len(ours), int(run.episode_lengths[episode]))
    return shortest if shortest < max(len(theirs), len(ours), int(run.episode_lengths[episode])) else None


class _Watched(gym.Wrapper[Any, Any, Any, Any]):
    """Keeps every action, and says how far the reference loop is."""

    def __init__(self, env: gym.Env, total: int, progress: Callable[[int, int], None] | None) -> None:
        super().__init__(env)
        self.actions: list[list[Any]] = []
        self._total = total
        self._progress = progress

    def reset(self, **kwargs: Any) -> Any:
        if self.actions and self._progress is not None:
            self._progress(len(self.actions), self._total)
        self.actions.append([])
        return self.env.reset(**kwargs)

    def step(self, action: Any) -> Any:
        self.actions[-1].append(action)
        return self.env.step(action)
