"""Several callbacks as one: which of them are called, and when."""

from collections.abc import Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, TypeAlias

from qtab.training.base_callback import BaseCallback
from qtab.training.progress import Callback, Progress
from qtab.training.resolved_run import PythonEnvironment, ResolvedRun

if TYPE_CHECKING:
    from qtab.results.run import Run

Callbacks: TypeAlias = Callback | Sequence[Callback]


class CallbackList:
    """The callbacks of a run. Those without an interval are called every ``every`` episodes.

    Raises:
        TypeError: if ``callbacks`` is neither a callable nor a sequence of callables.
    """

    def __init__(self, callbacks: Callbacks | None, every: int) -> None:
        self._callbacks = [(callback, _interval(callback) or every) for callback in as_tuple(callbacks)]

    def __bool__(self) -> bool:
        return bool(self._callbacks)

    def start(self, resolved: ResolvedRun, earlier: "Run | None" = None) -> ExitStack:
        """Starts the callbacks of a new run, or of one that continues ``earlier``.

        Returns:
            A context that ends the started callbacks when it exits.
        """
        environment = resolved.environment
        env = environment.env if isinstance(environment, PythonEnvironment) else None
        with ExitStack() as on_exit:
            for callback, _ in self._callbacks:
                if isinstance(callback, BaseCallback):
                    if earlier is None:
                        callback.on_start(resolved.config, env)
                    else:
                        callback.on_resume(resolved.config, env, earlier)
                    on_exit.callback(callback.on_end)
            return on_exit.pop_all()

    def next_call(self, done: int, total: int) -> int:
        """Returns the number of episodes at which the next callback is due, ``total`` at the latest."""
        return min([total, *((done // every + 1) * every for _, every in self._callbacks)])

    def __call__(self, progress: Progress) -> bool:
        """Calls those that are due; returns False if one of them stops the run.

        The others are then called as well, so that all have seen where the run ended.
        """
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
    """Returns the callbacks of a call: none, one, or those of a sequence.

    Raises:
        TypeError: for anything else, or for a class of callbacks instead of one that was made from it.
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
        raise TypeError(f"{name} must be made from its class, as in {callback.__name__}(...), got the class itself")
    return callback


def _interval(callback: Callback) -> int | None:
    return callback.every if isinstance(callback, BaseCallback) else None
