"""The environment of a run: stepped by Rust, or in Python, by one thread at a time."""

import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from typing import Any, TypeAlias

import gymnasium as gym

from qtab import _core
from qtab._spec import NativeEnvSpec, PythonEnvSpec
from qtab.discretizers import Discretizer
from qtab.envs.actions import Actions
from qtab.envs.registry import EnvEntry
from qtab.training.action_masks import NO_MASKS, ActionMasks

_lock = threading.Lock()
_threads: dict[int, tuple[int, int]] = {}
"""For each environment in use, by ``id(env)``: the thread that uses it, and the depth of nested uses."""


@dataclass(frozen=True)
class NativeEnvironment:
    """An environment that Rust steps."""

    entry: EnvEntry
    parameters: _core.NativeEnv

    def spec(self) -> NativeEnvSpec:
        """Returns the environment as the extension takes it."""
        return {"type": "native", "env": self.parameters}

    def exclusively(self) -> AbstractContextManager[None]:
        """Does nothing: each run has a separate environment."""
        return nullcontext()

    def close(self) -> None:
        """Does nothing: there is nothing to close."""


@dataclass(frozen=True)
class PythonEnvironment:
    """An environment that is stepped in Python."""

    env: gym.Env
    actions: Actions
    owns_env: bool
    """Whether to close the environment after the run."""
    masks: ActionMasks = NO_MASKS

    def spec(self) -> PythonEnvSpec:
        """Returns the environment as the extension takes it."""
        return {
            "type": "python",
            "env": self.env,
            "first_action": self.actions.first,
            "actions": self.actions.objects(),
            "action_mask": self.masks.source,
        }

    def exclusively(self) -> AbstractContextManager[None]:
        """Keeps other threads from training in the same environment."""
        return exclusively(self.env)

    def close(self) -> None:
        """Closes the environment, unless it is the user's."""
        if self.owns_env:
            self.env.close()


Environment: TypeAlias = NativeEnvironment | PythonEnvironment


class ObservedEnv(gym.Wrapper[Any, Any, Any, Any]):
    """Passes each observation through a discretizer before the extension reads it; the rest is unchanged."""

    def __init__(self, env: gym.Env, discretizer: Discretizer) -> None:
        super().__init__(env)
        self._discretizer = discretizer
        self.observation: Any = None
        """The last observation, as returned by the environment."""

    def _observe(self, observation: Any) -> Any:
        self.observation = observation
        return self._discretizer.observe(observation)

    def __str__(self) -> str:
        """Returns the text of the wrapped environment, for messages."""
        return str(self.env)

    def reset(self, **kwargs: Any) -> Any:
        """Resets the environment. The extension checks that the result follows Gymnasium's API."""
        answer: Any = self.env.reset(**kwargs)
        if isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[1], dict):
            return self._observe(answer[0]), answer[1]
        return answer

    def step(self, action: Any) -> Any:
        """Steps the environment; see :meth:`reset`."""
        answer: Any = self.env.step(action)
        if isinstance(answer, tuple) and len(answer) == 5:
            return self._observe(answer[0]), *answer[1:]
        return answer

    def of_observation(self, function: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """Wraps a function, such as one for action masks, so that it receives the original observations."""
        return lambda _read: function(self.observation)


@contextmanager
def exclusively(env: gym.Env) -> Iterator[None]:
    """Keeps other threads from training in the same environment, whatever wrappers they use.

    The same thread may use the environment again, as in a callback that evaluates.

    Raises:
        RuntimeError: if another thread uses the environment.
    """
    innermost = env.unwrapped
    key, thread = id(innermost), threading.get_ident()
    with _lock:
        owner, depth = _threads.get(key, (thread, 0))
        if owner != thread:
            raise RuntimeError(
                f"{innermost} is in use by another thread's training: two runs at a time would mix up their episodes, "
                "so give each thread a separate environment"
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
