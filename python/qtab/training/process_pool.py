"""Trains runs whose environments are stepped in Python, in worker processes."""

import _thread
import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager, suppress
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import cloudpickle

from qtab import _core
from qtab._spec import Results
from qtab.envs.registry import spec_of
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import ResolvedRun, masks_of

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

POLL_SECONDS = 0.2
"""The interval of checks for Ctrl-C, which cannot interrupt a wait on Windows."""
STOPPED = "the other runs were stopped"


def train_in_processes(
    env: Any,
    settings: Mapping[str, Any],
    seeds: Sequence[int],
    results: Results,
    workers: int,
    memory: tuple[int, int],
    report: Callable[[], bool],
) -> list[tuple[int, Exception]]:
    """Trains each seed in a worker process and fills in the results; returns the runs that failed first, if any.

    Calls ``report`` whenever more runs are finished; if it returns False, the other runs are stopped.
    """
    # cloudpickle also takes functions of the main script, as in Gymnasium's vector environments.
    limit, left = memory
    workers = min(workers, len(seeds))
    task = cloudpickle.dumps((_env_to_send(env), dict(settings), (limit, left // workers)))
    keep = results["tables"].shape[1] > 0
    with process_pool(workers, task) as executor:
        pending = {executor.submit(_train, seed, keep): index for index, seed in enumerate(seeds)}
        while pending:
            done, _ = wait(pending, timeout=POLL_SECONDS, return_when="FIRST_COMPLETED")
            ended = sorted(((pending.pop(future), future) for future in done), key=itemgetter(0))
            failed = [(index, error) for index, future in ended if (error := _fill(index, future, results))]
            if failed:
                return failed
            if done and not report():
                break
    return []


@contextmanager
def process_pool(workers: int, task: bytes | None = None) -> Iterator[ProcessPoolExecutor]:
    """A process pool that ends with its parent, leaves Ctrl-C to it, and stops its work when the context ends.

    Raises:
        RuntimeError: if a worker ended abruptly.
    """
    # Never fork: a copy of a process with threads can hang.
    context = multiprocessing.get_context("spawn")
    # A pipe has no lock, which a killed worker could still hold. No worker reads from it, so that all see what is sent.
    stop, ours = context.Pipe(duplex=False)
    with stop, ours:
        executor = ProcessPoolExecutor(workers, context, _start_worker, (stop, task))
        try:
            yield executor
        except BrokenProcessPool as error:
            raise RuntimeError(
                "a worker process ended abruptly; a script must keep its call behind if __name__ == '__main__':"
            ) from error
        finally:
            ours.send_bytes(b"stop")
            ours.close()  # also wakes workers that the message has not woken
            executor.shutdown(cancel_futures=True)


@contextmanager
def trained_in_python(
    env: Any, settings: Mapping[str, Any], seed: int, memory: tuple[int, int]
) -> Iterator[tuple[ResolvedRun, _core.Trainer]]:
    """Trains a run in an environment stepped in Python; yields the run and its trainer, and closes the environment.

    Args:
        env: The environment, or a function that makes it.
        settings: The settings of the run.
        seed: The seed of the run.
        memory: The result of :func:`qtab._utils.memory.memory_left`.

    Raises:
        InterruptedError: if this is a worker process, and its parent stops the pool.
        OverflowError: if the values of the tables have overflowed.
        Exception: any exception that the environment or the settings raise.
    """
    with closing(resolve(env() if callable(env) else env, {**settings, "seed": seed}, owns_env=True)) as resolved:
        trainer = _core.Trainer(resolved.spec(), resolved.seed, memory=memory)
        _Worker.training = True
        try:
            for episode in range(resolved.config.episodes):
                if _Worker.stopped:
                    raise InterruptedError(STOPPED)
                trainer.advance(episode + 1)
            trainer.check_tables()
        finally:
            _Worker.training = False
        yield resolved, trainer


def picklable(error: Exception) -> Exception:
    """Returns an error that can be pickled: the given error, or a RuntimeError with the same message."""
    try:
        back = pickle.loads(pickle.dumps(error))  # noqa: S301 - made here
    except Exception:
        back = None
    if type(back) is type(error) and str(back) == str(error):
        return error
    return RuntimeError(f"{type(error).__name__}: {error}")


def _env_to_send(env: Any) -> Any:
    """Returns the EnvSpec of an id: a worker has not imported the package that registered the id."""
    return spec_of(env) if isinstance(env, str) else env


def _fill(index: int, future: "Future[Any]", results: Results) -> Exception | None:
    answer = future.result()
    if isinstance(answer, Exception):
        return answer
    returns, lengths, terminated, tables, masks = answer
    results["returns"][index] = returns
    results["lengths"][index] = lengths
    results["terminated"][index] = terminated
    if tables is not None:
        results["tables"][index] = tables
        if masks is not None:
            results["masks"][index] = masks.ravel()
    results["finished"][index] = True
    return None


class _Worker:
    """The state of a worker process, and the data that it receives at its start."""

    stopped = False
    """Whether the parent has ended the pool."""
    training = False
    """Whether a run is in progress; the end of the pool interrupts it."""
    env: Any
    settings: Mapping[str, Any]
    memory: tuple[int, int]


def _start_worker(stop: "Connection", task: bytes | None) -> None:
    # Ctrl-C reaches the whole process group; only the parent handles it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _interrupt)
    threading.Thread(target=_end_with, args=(multiprocessing.parent_process(),), daemon=True).start()
    threading.Thread(target=_interrupt_after, args=(stop,), daemon=True).start()
    if task is not None:
        _Worker.env, _Worker.settings, _Worker.memory = pickle.loads(task)  # noqa: S301 - from the parent process


def _end_with(parent: Any) -> None:
    """Ends this process when its parent ends, even if the parent was killed."""
    parent.join()
    os._exit(1)


def _interrupt_after(stop: "Connection") -> None:
    """Interrupts the run in progress when the pool ends: its episode may never end."""
    with suppress(OSError):  # on Windows, the parent may have closed its end
        stop.poll(None)
    _Worker.stopped = True
    _thread.interrupt_main(signal.SIGTERM)


def _interrupt(number: int, _frame: Any) -> None:
    """Handles SIGTERM: sent at the end of the pool, it stops the run; otherwise it ends the process as usual."""
    if not _Worker.stopped:
        signal.signal(number, signal.SIG_DFL)
        signal.raise_signal(number)
    elif _Worker.training:
        raise InterruptedError(STOPPED)


def _train(seed: int, keep_tables: bool) -> Any:
    try:
        with trained_in_python(_Worker.env, _Worker.settings, seed, _Worker.memory) as (resolved, trainer):
            tables = trainer.tables() if keep_tables else None
            masks = masks_of(trainer, resolved) if keep_tables else None
            return *trainer.take_episodes(), tables, masks
    except Exception as error:
        return picklable(error)
