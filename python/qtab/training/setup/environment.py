"""The environment of a run, stepped by Rust or in Python by one thread at a time, and its action masks."""

import math
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab._spec import ActionMasksSpec, MaskSourceSpec, NativeEnvSpec, PythonEnvSpec
from qtab.config.functions import FORGOTTEN, Mask, checked_mask
from qtab.discretizers import Discretizer
from qtab.discretizers.identity import Identity
from qtab.envs.actions import Actions

MAX_KNOWN_STATES = 100_000
"""The most states for which masks are computed before the first episode."""


@dataclass(frozen=True, eq=False)
class ActionMasks:
    """The actions that each state allows."""

    source: MaskSourceSpec
    """The source of the mask of an observation, for an environment that is stepped in Python."""
    known: NDArray[np.bool_] | None = None
    """(rows, actions): the masks of all states, for an environment stepped in Rust."""

    def spec(self) -> ActionMasksSpec:
        """Returns the masks as the extension takes them."""
        return {"type": "observed"} if self.known is None else {"type": "known", "available": self.known}


WRITTEN_MASKS = ActionMasks({"type": "info"})
"""The masks that the functions of an environment in a capsule write at each step."""


def check_mask_is_given(action_mask: Mask) -> None:
    """Checks the setting ``action_mask`` of a run with masks.

    Raises:
        ValueError: for the setting of a saved run whose function is not given.
    """
    if isinstance(action_mask, str):
        raise ValueError(FORGOTTEN)


def observed_masks(action_mask: Mask, env: gym.Env) -> ActionMasks:
    """Returns the masks of an environment that is stepped in Python; ``action_mask`` must ask for masks."""
    function = action_mask if callable(action_mask) else mask_method(env)
    return ActionMasks({"type": "info"} if function is None else {"type": "function", "function": function})


def mask_method(env: gym.Env) -> Callable[[Any], Any] | None:
    """Returns a function that calls ``env.action_masks()``, sb3-contrib's convention; None without one."""
    try:
        method = env.get_wrapper_attr("action_masks")
    except AttributeError:
        return None
    return lambda _observation: method()


def known_masks(action_mask: Mask, env: gym.Env, discretizer: Discretizer, n_actions: int) -> ActionMasks | None:
    """Returns the masks of all states of an environment stepped in Rust; None if they cannot be known in advance.

    The masks are known if observations are discrete, and either the environment has Taxi's method
    ``action_mask(state)`` or the setting is a function that returns a mask for each observation. For a state that is
    never reached, the function may raise a ``LookupError`` or return an invalid mask. Python then steps the
    environment, and reaching such a state raises an error.

    Args:
        action_mask: The setting; it must ask for masks.
        env: The environment.
        discretizer: Maps observations to rows.
        n_actions: The length of a mask.

    Raises:
        Exception: any other exception of the function, with a note that names the observation (Python 3.11 or later).
    """
    from qtab.discretizers.time_aware import TimeAware

    if isinstance(discretizer, TimeAware):
        of_cells = known_masks(action_mask, env, discretizer.cells, n_actions)
        if of_cells is None or of_cells.known is None:
            return None
        return replace(of_cells, known=np.tile(of_cells.known, (discretizer.max_episode_steps, 1)))
    function = action_mask if callable(action_mask) else getattr(env.unwrapped, "action_mask", None)
    if function is None or not isinstance(discretizer, Identity) or discretizer.n_rows > MAX_KNOWN_STATES:
        return None
    known = np.empty((discretizer.n_rows, n_actions), np.bool_)
    for row, observation in enumerate(_observations(discretizer)):
        try:
            mask = function(observation)
        except LookupError:
            return None
        except Exception as error:
            if hasattr(error, "add_note"):
                error.add_note(f"in action_mask({observation!r}), asked before the first episode")
            raise
        try:
            known[row] = checked_mask("action_mask", mask, n_actions)
        except (TypeError, ValueError):
            return None
    return ActionMasks({"type": "info"}, known)


def _observations(discretizer: Identity) -> Iterator[Any]:
    """Yields the observation of each row, in the types of Gymnasium's environments."""
    low = np.ravel(discretizer.low).tolist()
    for cell in np.ndindex(discretizer.shape):
        numbers = tuple(first + index for first, index in zip(low, cell, strict=True))
        yield numbers if discretizer.low.shape else numbers[0]


def mask_bytes(discretizer: Discretizer, n_actions: int) -> int:
    """Returns the memory that the masks take while a run trains, in bytes."""
    return n_actions * (math.prod(discretizer.shape) if discretizer.n_active == 1 else 1)


_lock = threading.Lock()
_threads: dict[int, tuple[int, int]] = {}
"""For each environment in use, by ``id(env)``: the thread that uses it, and the depth of nested uses."""


@dataclass(frozen=True)
class NativeEnvironment:
    """An environment that Rust steps."""

    parameters: _core.NativeEnv
    external: _core.ExternalEnv | None = None
    """The environment of a capsule; None for one of this package."""

    def spec(self, discretizer: Discretizer) -> NativeEnvSpec:  # noqa: ARG002 - Rust reads the observations itself
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
    masks: ActionMasks | None = None
    """Its action masks; None if every state allows all actions."""

    def spec(self, discretizer: Discretizer) -> PythonEnvSpec:
        """Returns the environment as the extension takes it, with observations as the discretizer converts them."""
        env, mask = self.env, {"type": "none"} if self.masks is None else self.masks.source
        if discretizer.reads_space:
            env = ObservedEnv(env, discretizer)
            if mask["type"] == "function":
                mask = {"type": "function", "function": env.of_observation(mask["function"])}
        return {
            "type": "python",
            "env": env,
            "first_action": self.actions.first,
            "actions": self.actions.objects(),
            "action_mask": mask,
        }

    def exclusively(self) -> AbstractContextManager[None]:
        """Keeps other threads from training in the same environment."""
        return exclusively(self.env)

    def close(self) -> None:
        """Closes the environment, unless it is the user's."""
        if self.owns_env:
            self.env.close()


Environment: TypeAlias = NativeEnvironment | PythonEnvironment


def with_discretizer(environment: Environment, discretizer: Discretizer) -> tuple[Environment, bool]:
    """Returns an environment with a discretizer that reads its space, and whether Python must read its observations.

    The functions of an environment in a capsule write the components of any observation in the order of the space.
    """
    if not isinstance(environment, NativeEnvironment):
        return environment, True
    external, first = environment.external, discretizer.flat_first
    if external is None or first is None or len(first) != len(external.bounds):
        return environment, True
    return replace(environment, parameters=external.native_env(first)), False


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
