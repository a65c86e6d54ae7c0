"""What the callbacks of this package have in common, and what one of your own can be built on."""

import inspect
from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium as gym

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.training.progress import Progress

if TYPE_CHECKING:
    from qtab.results.run import Run


class BaseCallback(ABC):
    """A callback that is told when training begins and ends, and that may have its own interval.

    Any callable can be a callback; this class is for those that open files or keep a state. One object can serve
    several runs one after the other: :meth:`on_start` begins anew, and :meth:`on_resume` continues.

    Args:
        every: The number of episodes between two calls; None takes ``callback_every``.

    Raises:
        TypeError: if ``every`` is not an integer.
        ValueError: if it is less than one.
    """

    def __init__(self, every: int | None = None) -> None:
        self.every = None if every is None else checks.integer("every", every, least=1)

    def __repr__(self) -> str:
        """The arguments that differ from their defaults, as Python spells them."""
        parameters = inspect.signature(type(self)).parameters.values()
        found = {one.name: getattr(self, one.name, one.default) for one in parameters}
        changed = [one.name for one in parameters if repr(found[one.name]) != repr(one.default)]
        given = [f"{name}={_shown(found[name])}" for name in changed]
        return f"{type(self).__name__}({', '.join(given)})"

    def on_start(self, config: Config, env: gym.Env | None) -> None:  # noqa: B027 - need not do anything
        """Called before the first episode, to begin anew and to refuse what cannot work.

        Args:
            config: The complete config of the run.
            env: The environment that Python steps, which belongs to the run; None if Rust steps it.
        """

    def on_resume(self, config: Config, env: gym.Env | None, earlier: "Run") -> None:  # noqa: ARG002
        """Called instead of :meth:`on_start` when a run is resumed. By default it calls :meth:`on_start`.

        Args:
            config: The complete config of the whole run.
            env: As for :meth:`on_start`.
            earlier: The run that is resumed: its first episodes.
        """
        self.on_start(config, env)

    @abstractmethod
    def __call__(self, progress: Progress) -> bool | None:
        """Called after every ``every`` episodes and after the last one. It stops the run by returning False."""

    def on_end(self) -> None:  # noqa: B027 - need not do anything
        """Called once after :meth:`on_start` succeeded, also after an exception: closes what that opened."""


def _shown(value: Any) -> str:
    return repr(str(value)) if isinstance(value, Path) else shown(value)
