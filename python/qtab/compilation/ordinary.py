"""The compilation of ordinary Gymnasium classes, with its proof and its file."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.compilation.cache import machine_code
from qtab.compilation.cache.digest import digest_of
from qtab.compilation.cache.store import Store
from qtab.compilation.functional import require_numba
from qtab.compilation.interface.compiled_env import FUNCTIONS, CompiledEnv
from qtab.compilation.layouts.attribute_record import layout_of_record, with_observation
from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.not_compilable import NotCompilable, NotNow, combined
from qtab.compilation.proof import prove
from qtab.compilation.rewriting import Rewritten, rewrite
from qtab.compilation.twins.class_twin import ClassTwin, restored, twin_of
from qtab.compilation.twins.plain_data import shared_attributes
from qtab.compilation.twins.repetition import Repetition, Result
from qtab.compilation.twins.side_effects import refuse_effects
from qtab.envs.external.positions import FailedCall

_store = Store()


class OrdinaryEnv:
    """A compiled Gymnasium class.

    Args:
        env: The environment, without wrappers. It is not changed.
        name: Its name in messages; None takes that of its class.
        check: Called before the compilation, when the class is rewritten, to refuse it for other reasons.

    Raises:
        NotCompilable: if Numba is not installed, the class cannot be compiled, or compiled code gives other numbers
            than Python.
    """

    def __init__(
        self, env: gym.Env, name: str | None = None, check: "Callable[[OrdinaryEnv], None] | None" = None
    ) -> None:
        require_numba()
        self._name = f"<{type(env).__name__} instance>" if name is None else name
        observation = ObservationLayout.of(env.observation_space)
        shared = refuse_effects(env)
        self.env = twin_of(env)
        with restored(shared):
            self.rewritten = rewrite(self.env, shared_attributes(env, shared))
        _check_episodes(env, self.rewritten)
        if check is not None:
            check(self)
        self.record = with_observation(self.rewritten.dtype, observation)
        first = np.zeros(1, self.record)
        for name in self.rewritten.dtype.names or ():
            first[name] = self.rewritten.initial[name]
        self.parameters: NDArray[np.uint8] = first.view(np.uint8).reshape(-1).copy()
        self.compiled = self._compiled(observation)

    def capsule(self) -> Any:
        """Returns the capsule ``qtab.env.1``."""
        return self.compiled.capsule(self.parameters)

    @property
    def code(self) -> str:
        """A digest of the code, the attributes and the layout of the states, for states that are stored."""
        parts = [self.rewritten.source, str(self.record.descr), self.parameters.tobytes().hex()]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def repeat(self, failed: FailedCall, reads_masks: bool = False) -> tuple[Result, Callable[[int], Result]]:
        """Repeats a call in Python that failed in compiled code; it raises the error, if there is one in Python.

        Args:
            failed: The call.
            reads_masks: Whether the run reads the action masks, so that a wrong one is an error.

        Returns:
            The result, and a function of an action that takes the next step.
        """
        repetition = self._repetition(failed, reads_masks=reads_masks)
        if failed.action is None:
            result = repetition.reset(failed.before)
        else:
            if failed.played is not None:
                repetition.play(*failed.played, failed.before)
            elif failed.state is not None:
                repetition.raise_error(failed.state, failed.before, failed.action)
            result = repetition.step(failed.action)
        repetition.log()
        return result, repetition.step

    def repeat_in_vector(self, failed: FailedCall) -> None:
        """Repeats a call of a sub-environment in Python; see :meth:`repeat`. It raises the error of Python, if any."""
        repetition = self._repetition(failed, np.int64)  # as Gymnasium's vector environments pass actions
        if failed.action is None or failed.played is None:
            repetition.begin(failed.before)
        else:
            repetition.play(*failed.played, failed.before)
            repetition.take(failed.action)
        repetition.log("a vector environment of %s is stepped in Python from now on")

    def _repetition(
        self, failed: FailedCall, number: type[int | np.int64] = int, reads_masks: bool = False
    ) -> Repetition:
        twin = ClassTwin(self.env, self.record, self.compiled.observation, self.compiled.has_action_mask)
        return Repetition(twin, failed.seed, self._name, number, reads_masks)

    def _compiled(self, observation: ObservationLayout) -> CompiledEnv:
        space: Any = self.env.action_space
        masked = self.rewritten.action_mask is not None
        layout = layout_of_record(self.record)
        file = type(self.env).step.__code__.co_filename
        functions: dict[str, Any] = {"reset": self.rewritten.reset, "step": self.rewritten.step}
        if self.rewritten.action_mask is not None:
            functions["action_mask"] = self.rewritten.action_mask
        bounds = [observation.low, observation.high, repr(space), repr(self.env.observation_space)]
        # Messages name the user's lines, which may move while the rewritten source stays the same.
        lines = [(at, Path(name).name, line) for at, (name, line) in sorted(self.rewritten.lines.items())]
        digest = digest_of(functions, [self.rewritten.source, lines, str(self.record.descr), *bounds])

        def make() -> tuple[machine_code.MachineCode, dict[str, Any]]:
            return self._make(observation), {}

        def load(code: machine_code.MachineCode, _: dict[str, Any]) -> CompiledEnv:
            return CompiledEnv(machine_code.load(code, FUNCTIONS), layout, observation, int(space.n), masked)

        return _store.compiled(digest, file, self.parameters, make, load, self._prove)

    def _make(self, observation: ObservationLayout) -> machine_code.MachineCode:
        from qtab.compilation.c_functions import compiler
        from qtab.compilation.c_functions.record_shims import compile_record
        from qtab.compilation.rewriting.tuple_observations import with_tuple_observations

        rewritten = with_tuple_observations(self.rewritten)
        space: Any = self.env.action_space
        name = type(self.env).__name__

        def compile_functions(report: compiler.Report) -> dict[str, Any]:
            return compile_record(rewritten, self.record, observation, int(space.n), int(space.start), report)

        try:
            return compiler.compiled(name, {f"<{name}>"}, compile_functions)
        except NotNow:
            raise
        except NotCompilable as refusal:
            raise _of_users_line(rewritten.lines, refusal) from None

    def _prove(self, compiled: CompiledEnv) -> None:
        twin = ClassTwin(self.env, self.record, compiled.observation, compiled.has_action_mask)
        try:
            functions: list[Any] = [type(self.env).step, type(self.env).reset]
            prove(twin, compiled, self.parameters, functions)
        except NotCompilable as refusal:
            reason = refusal.reason
            for i, name in enumerate(self.record.names or ()):
                reason = reason.replace(f"state[{i}]", f"self.{name}")
            raise type(refusal)(reason, refusal.file, refusal.line, refusal.advice, refusal.others) from None


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


def _of_users_line(lines: dict[int, tuple[str, int]], refusal: NotCompilable) -> NotCompilable:
    """Returns an error for the user's lines, given one for lines of the rewritten functions; each is listed once."""
    mapped = []
    for one in (refusal, *refusal.others):
        file, line = lines.get(one.line or 0, (None, None))
        mapped.append(NotCompilable(one.reason, file, line, one.advice))
    return combined(mapped)
