"""Runs whose environments are stepped in Python: in processes of the call's own."""

import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from operator import itemgetter
from typing import Any

import cloudpickle

from qtab import _core, _spec
from qtab.envs.registry import spec_of
from qtab.training.resolve import resolve

WAIT = 0.2
"""Seconds between two looks for Ctrl-C, which on Windows does not interrupt a wait."""


def train_in_processes(
    env: Any, overrides: Mapping[str, Any], seeds: tuple[int, ...], results: _spec.Results, workers: int
) -> list[tuple[int, Exception]]:
    """Trains each seed in a worker process and fills in the results as they come; returns the first failure."""
    # cloudpickle, as in Gymnasium's own vector environments, takes functions of the main script along.
    task = cloudpickle.dumps((_portable_env(env), dict(overrides)))
    keep = results["tables"].shape[1] > 0
    with pool(min(workers, len(seeds)), task) as executor:
        pending = {executor.submit(_train, seed, keep): index for index, seed in enumerate(seeds)}
        while pending:
            done, _ = wait(pending, timeout=WAIT, return_when="FIRST_COMPLETED")
            ended = sorted(((pending.pop(future), future) for future in done), key=itemgetter(0))
            failed = [(index, error) for index, future in ended if (error := _fill(index, future, results))]
            if failed:
                return failed
    return []


@contextmanager
def pool(workers: int, task: bytes | None = None) -> Iterator[ProcessPoolExecutor]:
    """A process pool that does not outlive its parent, leaves Ctrl-C to it, and stops when it is left.

    Raises:
        RuntimeError: if a worker ended abruptly.
    """
    # Never fork: a copy of a process with threads may hang.
    context = multiprocessing.get_context("spawn")
    stop = context.Event()
    executor = ProcessPoolExecutor(workers, context, _begin, (stop, task))
    try:
        yield executor
    except BrokenProcessPool as error:
        raise RuntimeError(
            "a worker process ended abruptly; where this is a script, it must keep its call behind "
            "if __name__ == '__main__':"
        ) from error
    finally:
        stop.set()
        executor.shutdown(cancel_futures=True)


def train_to_the_end(trainer: _core.Trainer, episodes: int) -> None:
    """Trains, unless the parent has left.

    Raises:
        InterruptedError: where it has.
    """
    for episode in range(episodes):
        if _Worker.stop is not None and _Worker.stop.is_set():
            raise InterruptedError("the other runs were stopped")
        trainer.advance(episode + 1)


def _portable_env(env: Any) -> Any:
    """An id as its EnvSpec: a worker has not imported what registered it."""
    return spec_of(env) if isinstance(env, str) else env


def _fill(index: int, future: "Future[Any]", results: _spec.Results) -> Exception | None:
    answer = future.result()
    if isinstance(answer, Exception):
        return answer
    returns, lengths, terminated, tables = answer
    results["returns"][index] = returns
    results["lengths"][index] = lengths
    results["terminated"][index] = terminated
    if tables is not None:
        if tables.size != results["tables"].shape[1]:
            # A learner with several tables: only its first run tells.
            results["tables"].resize((len(results["finished"]), tables.size), refcheck=False)
        results["tables"][index] = tables
    results["finished"][index] = True
    return None


class _Worker:
    """What a worker process was told when it began."""

    stop: Any = None
    env: Any
    overrides: Mapping[str, Any]


def _begin(stop: Any, task: bytes | None) -> None:
    # Ctrl-C reaches the whole group of processes; the parent decides.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_follow, args=(multiprocessing.parent_process(),), daemon=True).start()
    _Worker.stop = stop
    if task is not None:
        _Worker.env, _Worker.overrides = pickle.loads(task)  # noqa: S301 - from the parent process


def _follow(parent: Any) -> None:
    """Ends this process with its parent, even where that was killed."""
    parent.join()
    os._exit(1)


def _train(seed: int, tables: bool) -> Any:
    try:
        env = _Worker.env() if callable(_Worker.env) else _Worker.env
        resolved = resolve(env, {**_Worker.overrides, "seed": seed})
        try:
            trainer = _core.Trainer(resolved.spec(), resolved.seed)
            train_to_the_end(trainer, resolved.config.episodes)
            return *trainer.episodes(), trainer.tables() if tables else None
        finally:
            if resolved.env is not None:
                resolved.env.close()
    except Exception as error:
        return portable(error)


def portable(error: Exception) -> Exception:
    """Returns an error that can travel between processes: itself, or one that says the same."""
    try:
        back = pickle.loads(pickle.dumps(error))  # noqa: S301 - made here
    except Exception:
        back = None
    if type(back) is type(error) and str(back) == str(error):
        return error
    return RuntimeError(f"{type(error).__name__}: {error}")


__all__ = ["pool", "train_in_processes", "train_to_the_end"]
