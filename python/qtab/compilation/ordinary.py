"""The compilation of ordinary Gymnasium classes, with its proof and its file."""

import copy
import logging
import time
import warnings
from itertools import count
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.progress import ProgressBar
from qtab.compilation.cache import machine_code
from qtab.compilation.cache.digest import digest_of
from qtab.compilation.cache.store import Store
from qtab.compilation.functional import SLOW_SECONDS, require_numba
from qtab.compilation.interface.compiled_env import FUNCTIONS, CompiledEnv
from qtab.compilation.layouts.attribute_record import layout_of_record, restore, state_bytes, with_observation
from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.not_compilable import NotCompilable, NotNow
from qtab.compilation.proof import prove
from qtab.compilation.rewriting import Rewritten, rewrite

_logger = logging.getLogger("qtab")
_store = Store()


class OrdinaryEnv:
    """A compiled Gymnasium class.

    Args:
        env: The environment, without wrappers. It is not changed.

    Raises:
        NotCompilable: if Numba is not installed, the class cannot be compiled, or compiled code gives other numbers
            than Python.
    """

    def __init__(self, env: gym.Env) -> None:
        require_numba()
        observation = ObservationLayout.of(env.observation_space)
        self.env = env
        self.rewritten = rewrite(env)
        _check_episodes(env, self.rewritten)
        self.record = with_observation(self.rewritten.dtype, observation)
        first = np.zeros(1, self.record)
        for name in self.rewritten.dtype.names or ():
            first[name] = self.rewritten.initial[name]
        self.parameters: NDArray[np.uint8] = first.view(np.uint8).reshape(-1).copy()
        self.compiled = self._compiled(observation)

    def capsule(self) -> Any:
        """Returns the capsule ``qtab.env.1``."""
        return self.compiled.capsule(self.parameters)

    def failed(self, state: bytes | None, action: int | None, rng: np.random.Generator) -> None:
        """Repeats a call in Python that failed in compiled code, so that it raises the error.

        Args:
            state: The bytes of the state before the step; None for a reset.
            action: The action, counted from 0; None for a reset.
            rng: A generator in the state before the call.

        Raises:
            RuntimeError: if the call does not fail in Python.
        """
        twin = ClassTwin(self.env, self.record, self.compiled.observation)
        if state is None or action is None:
            observation = twin.reset_class(rng)
        else:
            twin.reset_class(np.random.default_rng(0))
            restore(self.record, twin.env, state)
            observation = twin.step_class(action, rng)[0]
        name = type(self.env).__name__
        if not self.env.observation_space.contains(observation):
            raise ValueError(f"{name} returned an observation outside its space: {observation!r}")
        raise RuntimeError(f"{name} failed in compiled code, but not in Python; train with backend='gymnasium'")

    def _compiled(self, observation: ObservationLayout) -> CompiledEnv:
        space: Any = self.env.action_space
        masked = self.rewritten.action_mask is not None
        layout = layout_of_record(self.record)
        file = type(self.env).step.__code__.co_filename
        functions: dict[str, Any] = {"reset": self.rewritten.reset, "step": self.rewritten.step}
        if self.rewritten.action_mask is not None:
            functions["action_mask"] = self.rewritten.action_mask
        bounds = [observation.low, observation.high, repr(space), repr(self.env.observation_space)]
        digest = digest_of(functions, [self.rewritten.source, str(self.record.descr), *bounds])

        def make() -> tuple[machine_code.MachineCode, dict[str, Any]]:
            return self._make(observation), {}

        def load(code: machine_code.MachineCode, _: dict[str, Any]) -> CompiledEnv:
            return CompiledEnv(machine_code.load(code, FUNCTIONS), layout, observation, int(space.n), masked)

        return _store.compiled(digest, file, self.parameters, make, load, self._prove)

    def _make(self, observation: ObservationLayout) -> machine_code.MachineCode:
        started = time.perf_counter()
        from numba.core.errors import NumbaError

        from qtab.compilation.c_functions.functional_shims import ARGUMENTS, STAGES
        from qtab.compilation.c_functions.record_shims import compile_record
        from qtab.compilation.checks.numba_errors import not_compilable

        space: Any = self.env.action_space
        name = type(self.env).__name__
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                with ProgressBar(STAGES, "stage", None, f"compiling {name}") as bar:
                    done = count(1)
                    functions = compile_record(
                        self.rewritten,
                        self.record,
                        observation,
                        int(space.n),
                        int(space.start),
                        lambda: bar.move_to(next(done)),
                    )
                made = machine_code.make(functions, ARGUMENTS)
            except NumbaError as error:
                raise self._of_users_line(not_compilable(error, {f"<{name}>"})) from None
            except (NotCompilable, machine_code.CannotLoad):
                raise
            except Exception as error:  # an internal error of Numba; Python can step the environment
                raise NotNow(f"Numba failed with {type(error).__name__}: {error}") from None
        seconds = time.perf_counter() - started
        if seconds > SLOW_SECONDS:
            _logger.info("compiled %s in %.1f s", name, seconds)
        return made

    def _of_users_line(self, refusal: NotCompilable) -> NotCompilable:
        """Returns an error for the user's line, given one for a line of the rewritten functions."""
        place = self.rewritten.lines.get(refusal.line or 0)
        file, line = place if place is not None else (None, None)
        return NotCompilable(refusal.reason, file, line, refusal.advice)

    def _prove(self, compiled: CompiledEnv) -> None:
        twin = ClassTwin(self.env, self.record, compiled.observation)
        try:
            functions: list[Any] = [type(self.env).step, type(self.env).reset]
            prove(twin, compiled, self.parameters, functions)
        except NotCompilable as refusal:
            reason = refusal.reason
            for i, name in enumerate(self.record.names or ()):
                reason = reason.replace(f"state[{i}]", f"self.{name}")
            raise type(refusal)(reason, refusal.file, refusal.line, refusal.advice) from None


def _check_episodes(env: gym.Env, rewritten: Rewritten) -> None:
    if rewritten.kept_between_episodes:
        name = rewritten.kept_between_episodes[0]
        code = type(env).reset.__code__
        raise NotCompilable(
            f"self.{name} keeps its value from one episode to the next",
            code.co_filename,
            code.co_firstlineno,
            f"assign self.{name} in reset, before it is read",
        )


class ClassTwin:
    """Steps a copy of an environment in Python.

    Args:
        env: The environment.
        record: The record with the observation.
        observation: The layout of its observations.
    """

    def __init__(self, env: gym.Env, record: np.dtype[Any], observation: ObservationLayout) -> None:
        self.env: Any = copy.deepcopy(env)
        self._record, self._observation = record, observation
        space: Any = env.action_space
        self._start = int(space.start)

    def reset_class(self, rng: np.random.Generator) -> Any:
        """Resets the copy with a generator, and returns the observation."""
        self.env._np_random = rng
        observation, self._info = self.env.reset()
        return observation

    def step_class(self, action: int, rng: np.random.Generator) -> Any:
        """Takes an action, counted from 0, and returns what ``step`` does."""
        self.env._np_random = rng
        stepped = self.env.step(self._start + action)
        self._info = stepped[4]
        return stepped

    def reset(self, rng: np.random.Generator) -> dict[str, Any]:
        """Resets the copy, and returns the numbers by their names."""
        return self._numbers(self.reset_class(rng))

    def step(self, action: int, rng: np.random.Generator) -> dict[str, Any]:
        """Takes an action, counted from 0, and returns the numbers by their names."""
        observation, reward, terminated, truncated, _ = self.step_class(action, rng)
        flags = {"terminated": bool(terminated), "truncated": bool(truncated)}
        return {"reward": float(reward), **flags, **self._numbers(observation)}

    def _numbers(self, given: Any) -> dict[str, Any]:
        observation = self._observation.numbers(self._in_order(self.env.observation_space, given))
        mask = self.env.action_masks() if hasattr(self.env, "action_masks") else self._info.get("action_mask")
        numbers = {"observation": observation, "state": state_bytes(self._record, self.env, observation)}
        return numbers if mask is None else {**numbers, "action_mask": np.asarray(mask).astype(np.uint8)}

    def _in_order(self, space: Any, given: Any) -> Any:
        """Returns an observation with the keys of dicts in the order of their spaces."""
        if isinstance(space, gym.spaces.Dict):
            return {key: self._in_order(inner, given[key]) for key, inner in space.spaces.items()}
        if isinstance(space, gym.spaces.Tuple):
            return tuple(self._in_order(inner, part) for inner, part in zip(space.spaces, given, strict=True))
        return given
