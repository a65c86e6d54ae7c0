"""The arguments of ``train`` that are not settings and change no result: callbacks, and the options beside them."""

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import gymnasium as gym

from qtab import _core
from qtab._utils import checks
from qtab._utils.memory import memory_limit as bytes_limit
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.training.progress import Callback, EpisodeReader, Progress
from qtab.training.setup.environment import PythonEnvironment
from qtab.training.setup.resolved_run import ResolvedRun

if TYPE_CHECKING:
    from qtab.results.run import Run

Callbacks: TypeAlias = Callback | Sequence[Callback]


class BaseCallback(ABC):
    """Base class of callbacks that are notified when training begins and ends, and that may set their own interval.

    Any callable can be a callback; this class is for callbacks that open files or keep state. One object can serve
    several runs in turn: :meth:`on_start` starts afresh, and :meth:`on_resume` continues.

    Args:
        every: The number of episodes between two calls; None takes ``callback_every``.

    Raises:
        TypeError: if ``every`` is not an integer.
        ValueError: if ``every`` is less than one.
    """

    def __init__(self, every: int | None = None) -> None:
        self.every = None if every is None else checks.integer("every", every, least=1)

    def __repr__(self) -> str:
        """Returns the call that makes this callback, with the arguments that differ from their defaults."""
        parameters = inspect.signature(type(self)).parameters.values()
        found = {one.name: getattr(self, one.name, one.default) for one in parameters}
        changed = [one.name for one in parameters if repr(found[one.name]) != repr(one.default)]
        given = [f"{name}={_shown(found[name])}" for name in changed]
        return f"{type(self).__name__}({', '.join(given)})"

    def on_start(self, config: Config, env: gym.Env | None) -> None:  # noqa: B027 - need not do anything
        """Called before the first episode, to start afresh and to reject a run that the callback cannot handle.

        Args:
            config: The complete config of the run.
            env: The run's environment if Python steps it; None if Rust does.
        """

    def on_resume(self, config: Config, env: gym.Env | None, earlier: "Run") -> None:  # noqa: ARG002
        """Called instead of :meth:`on_start` when a run is resumed. By default it calls :meth:`on_start`.

        Args:
            config: The complete config of the whole run.
            env: As for :meth:`on_start`.
            earlier: The run that is resumed, with its first episodes.
        """
        self.on_start(config, env)

    @abstractmethod
    def __call__(self, progress: Progress) -> bool | None:
        """Called every ``every`` episodes and after the last one. Returning False stops the run."""

    def on_end(self) -> None:  # noqa: B027 - need not do anything
        """Called once at the end if :meth:`on_start` succeeded, also after an exception, to close files."""


def _shown(value: Any) -> str:
    return repr(str(value)) if isinstance(value, Path) else shown(value)


class CallbackList:
    """The callbacks of a run, which read its progress. Those without an interval are called every ``every`` episodes.

    Raises:
        TypeError: if ``callbacks`` is neither a callable nor a sequence of callables.
    """

    def __init__(self, callbacks: Callbacks | None, every: int) -> None:
        self._callbacks = tuple((callback, _interval(callback) or every) for callback in as_tuple(callbacks))
        self._reader: EpisodeReader | None = None

    def start(
        self,
        trainer: _core.Trainer,
        resolved: ResolvedRun,
        began: float,
        make_run: "Callable[[], Run]",
        earlier: "Run | None" = None,
    ) -> ExitStack:
        """Starts the callbacks of a new run, or of one that continues ``earlier``.

        Args:
            trainer: The trainer of the run.
            resolved: The run.
            began: The time when the run began.
            make_run: Makes the run so far.
            earlier: The earlier part of the run, if any.

        Returns:
            A context that ends the started callbacks when it exits.
        """
        with ExitStack() as on_exit:
            if self._callbacks:
                self._reader = on_exit.enter_context(EpisodeReader(trainer, resolved, began, make_run))
            environment = resolved.environment
            env = environment.env if isinstance(environment, PythonEnvironment) else None
            for callback, _ in self._callbacks:
                if isinstance(callback, BaseCallback):
                    if earlier is None:
                        callback.on_start(resolved.config, env)
                    else:
                        callback.on_resume(resolved.config, env, earlier)
                    on_exit.callback(callback.on_end)
            return on_exit.pop_all()

    def next_call(self, done: int, total: int) -> int:
        """Returns the number of episodes at which the next callback is due, ``total`` at the latest.

        Training then continues, and the last Progress can no longer read the tables.
        """
        due = total
        for _, every in self._callbacks:
            due = min(due, (done // every + 1) * every)
        if self._reader is not None:
            self._reader.move_on()
        return due

    def call(self) -> bool:
        """Calls the callbacks that are due; returns False if one of them stops the run.

        All others are then called as well, so that every callback sees the end of the run.
        """
        if self._reader is None:
            return True
        progress = self._reader.read()
        at_end, proceed = progress.episodes == progress.total, True
        for callback, every in self._callbacks:
            if at_end or progress.episodes % every == 0:
                answer = callback(progress)
                proceed = proceed and (answer is None or bool(answer))  # NumPy's False stops, too
        if not proceed and not at_end:
            for callback, every in self._callbacks:
                if progress.episodes % every:
                    callback(progress)
        return proceed


def as_tuple(callbacks: Any) -> tuple[Any, ...]:
    """Returns the callbacks as a tuple, given None, one callback or a sequence.

    Raises:
        TypeError: for anything else, or for a callback class instead of an instance.
    """
    if callbacks is None:
        return ()
    if not callable(callbacks) and isinstance(callbacks, Sequence) and not isinstance(callbacks, str | bytes):
        return tuple(_checked(f"callback[{index}]", callback) for index, callback in enumerate(callbacks))
    return (_checked("callback", callbacks),)


def _checked(name: str, callback: Any) -> Any:
    if not callable(callback):
        raise TypeError(f"{name} must be callable, got {callback!r}")
    if isinstance(callback, type) and issubclass(callback, BaseCallback):
        raise TypeError(f"{name} must be an instance, as in {callback.__name__}(...), got the class itself")
    return callback


def _interval(callback: Callback) -> int | None:
    return callback.every if isinstance(callback, BaseCallback) else None


CALLBACK_EVERY = 100


@dataclass(frozen=True)
class TrainingOptions:
    """The arguments of :func:`qtab.train` and :func:`qtab.resume` that are not settings, checked.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    callback: Callbacks | None = None
    callback_every: int = CALLBACK_EVERY
    record: int = 0
    visits: bool = False
    snapshots: int | Sequence[int] | None = None
    """Checked once the number of episodes is known."""
    progress: bool | None = None
    memory_limit: int | None = None

    def __post_init__(self) -> None:
        """Checks the arguments before the environment is made."""
        checks.integer("callback_every", self.callback_every, least=1)
        checks.count("record", self.record, least=0)
        checks.boolean("visits", self.visits)
        bytes_limit(self.memory_limit)
        CallbackList(self.callback, self.callback_every)
