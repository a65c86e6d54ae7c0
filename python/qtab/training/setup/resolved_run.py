"""A completely described run, the input of training."""

import logging
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab._spec import RunSpec
from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.config.options import is_set
from qtab.discretizers import Discretizer
from qtab.envs.actions import Actions
from qtab.training.setup.environment import ActionMasks, Environment, NativeEnvironment

_LOGGER = logging.getLogger("qtab")
_logged: set[str] = set()
"""The messages logged in this process, and the environments whose default time limit was logged."""


@dataclass(frozen=True, eq=False)
class ResolvedRun:
    """The environment found, its spaces matched, and every setting filled in."""

    config: Config
    """All settings, as in ``run.config`` and in files."""
    environment: Environment
    discretizer: Discretizer
    actions: Actions
    masks: ActionMasks | None
    """The action masks; None if every state allows all actions."""
    seed: int
    max_episode_steps: int
    default_time_limit: bool
    """Whether the environment has no time limit, so that ``max_episode_steps`` is qtab's default."""
    python_reason: str | None
    """The reason why the environment is stepped in Python although this was not requested, and a remedy; else None."""
    extensions: tuple[tuple[int, int], ...] = ()
    """As in :class:`qtab.results.run_state.RunState`."""

    @property
    def is_native(self) -> bool:
        """Whether Rust steps the environment."""
        return isinstance(self.environment, NativeEnvironment)

    def close(self) -> None:
        """Closes the environment, unless it is the user's."""
        self.environment.close()

    def with_seed(self, seed: int) -> "ResolvedRun":
        """Returns the same run with another seed, which must be valid for the bit generator."""
        return replace(self, seed=seed, config=replace_checked(self.config, seed=seed))

    def spec(self) -> RunSpec:
        """Returns the run without its seed, as the extension takes it."""
        return {
            "env": self.environment.spec(self.discretizer),
            "discretizer": self.discretizer.spec(),
            "num_actions": len(self.actions),
            "max_episode_steps": self.max_episode_steps,
            "action_masks": {"type": "none"} if self.masks is None else self.masks.spec(),
            "settings": vars(self.config),
        }


def masks_of(trainer: _core.Trainer, resolved: ResolvedRun) -> NDArray[np.bool_] | None:
    """Returns (*cells, actions): the last mask seen in each cell; None without masks or without cells."""
    masks = trainer.action_masks() if resolved.discretizer.has_cells else None
    return None if masks is None else masks.reshape(*resolved.discretizer.shape, len(resolved.actions))


def derived_settings(asked: Config, config: Config, discretizer: Discretizer) -> frozenset[str]:
    """Returns the settings that were not given but follow from the environment or from other settings.

    Args:
        asked: The settings given, and those of the preset.
        config: All settings of the run.
        discretizer: The discretizer of the run.
    """
    names = {"max_episode_steps", *discretizer.settings()}
    derived = {name for name in names if not is_set(getattr(asked, name)) and is_set(getattr(config, name))}
    if asked.backend == "auto":
        derived.add("backend")
    if asked.discretizer == "round" and config.discretizer == "identity":
        derived.add("discretizer")
    return frozenset(derived)


def time_limit_notice(run: ResolvedRun) -> str:
    """Returns the message for a run whose time limit is qtab's default (``run.default_time_limit``)."""
    return f"{run.config.env} has no time limit: an episode ends after {run.max_episode_steps:,} steps"


def log_default_limit(run: ResolvedRun) -> None:
    """Logs that the time limit is qtab's default, once per process and environment."""
    if run.default_time_limit and run.config.env not in _logged:
        _logged.add(run.config.env)
        _LOGGER.warning("%s; max_episode_steps= sets another", time_limit_notice(run))


def log_python_stepping(run: ResolvedRun) -> None:
    """Logs why an environment is stepped in Python if this was not requested, once per process and reason."""
    if run.python_reason is not None:
        message = f"{run.config.env} is stepped in Python, which is much slower than Rust: {run.python_reason}"
        if message not in _logged:
            _logged.add(message)
            _LOGGER.warning("%s", message)
