"""One thread at a time in one environment: two would mix up their episodes."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import gymnasium as gym

_lock = threading.Lock()
_threads: dict[int, tuple[int, int]] = {}
"""For each environment in use, by its id: the thread that uses it, and how many times over."""


@contextmanager
def exclusively(env: gym.Env) -> Iterator[None]:
    """Keeps other threads from training in the same environment, whichever wrappers they see it through.

    The thread itself may use it again, as a callback does that evaluates.

    Raises:
        RuntimeError: if another thread uses it.
    """
    innermost = env.unwrapped
    key, thread = id(innermost), threading.get_ident()
    with _lock:
        owner, depth = _threads.get(key, (thread, 0))
        if owner != thread:
            raise RuntimeError(
                f"{innermost} is being trained in by another thread: two runs at a time would mix up their episodes, "
                "so give each thread an environment of its own"
            )
        _threads[key] = (thread, depth + 1)
    try:
        yield
    finally:
        with _lock:
            if depth:
                _threads[key] = (thread, depth)
            else:
                del _threads[key]
