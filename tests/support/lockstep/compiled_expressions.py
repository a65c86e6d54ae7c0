"""Expressions compiled as parts of users' functions, beside the same expressions in Python.

Arguments are the integers ``n`` and ``m``, the floats ``x`` and ``y``, and the booleans ``p`` and ``q``.
"""

import linecache
import math
from collections.abc import Callable
from itertools import count
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from qtab.compilation import NotCompilable

NAMES = ("n", "m", "x", "y", "p", "q")
FAILED = "the step is repeated in Python"
_numbers = count()


def defined(text: str, **known: Any) -> dict[str, Any]:
    """Returns the names that a text defines, whose source can be read."""
    file = f"<expression {next(_numbers)}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    scope: dict[str, Any] = {"np": np, "math": math, "gym": gym, "spaces": spaces, **known}
    exec(compile(text, file, "exec"), scope)  # noqa: S102 - the test's own text
    return scope


def in_python(expression: str) -> Callable[..., Any]:
    """Returns an expression as a function of the arguments."""
    function: Callable[..., Any] = defined(f"def value({', '.join(NAMES)}):\n    return {expression}\n")["value"]
    return function


def in_functional_env(expression: str) -> Callable[..., Any]:
    """Returns an expression as it is compiled in a function of a ``FunctionalEnv``.

    Raises:
        NotCompilable: if it is refused.
    """
    import numba
    from numba.core.errors import NumbaError

    from qtab.compilation.c_functions.dispatchers import FunctionCompiler
    from qtab.compilation.checks.checked_operations import OPTIONS
    from qtab.compilation.checks.mixed_numbers import callees
    from qtab.compilation.checks.typed_code import refusals

    refusals.clear()
    callees.clear()
    types = numba.core.types
    compiled = FunctionCompiler().dispatcher(in_python(expression))  # type: ignore[arg-type]
    try:
        compiled.compile((types.int64,) * 2 + (types.float64,) * 2 + (types.boolean,) * 2)
    except NumbaError as error:
        raise NotCompilable(str(error)) from None
    if refusals:
        raise refusals[0]
    options = {**OPTIONS, "no_cpython_wrapper": False}
    called = numba.njit(**options)(defined(_CALL, compiled=compiled)["call"])
    return lambda *values: _outcome(called, *values)


_CALL = f"def call({', '.join(NAMES)}):\n    return compiled({', '.join(NAMES)})\n"


class Numbers(gym.Env[Any, Any]):
    """The base of a class whose reward is an expression of its attributes."""

    observation_space: gym.Space[Any] = spaces.Discrete(2)
    action_space: gym.Space[Any] = spaces.Discrete(2)

    def __init__(self) -> None:
        self.n, self.m, self.x, self.y, self.p, self.q = 1, 2, 0.5, 1.5, True, False

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.n, self.m, self.x, self.y, self.p, self.q = 1, 2, 0.5, 1.5, True, False
        return 0, {}


def in_ordinary_class(expression: str) -> Callable[..., Any]:
    """Returns an expression as it is rewritten and compiled in the method ``step`` of a Gymnasium class.

    Raises:
        NotCompilable: if it is refused.
    """
    from numba.core.errors import NumbaError

    from qtab.compilation.checks.mixed_numbers import callees
    from qtab.compilation.checks.typed_code import refusals
    from qtab.compilation.rewriting import rewrite
    from support.lockstep.rewriting import compiled_with_checks

    callees.clear()
    unpacked = "".join(f"        {name} = self.{name}\n" for name in NAMES)
    text = f"class Made(Numbers):\n    def step(self, action):\n{unpacked}        reward = {expression}\n"
    # The attributes change, so that they are not constants.
    changed = "        self.n, self.m, self.x, self.y, self.p, self.q = m, n, y, x, q, p\n"
    env = defined(f"{text}{changed}        return 0, reward, False, False, {{}}\n", Numbers=Numbers)["Made"]()
    rewritten = rewrite(env)
    functions = compiled_with_checks(rewritten)
    rng = np.random.default_rng(0)

    def step(*values: Any) -> Any:
        record = rewritten.initial.copy()[0:1][0]
        for name, value in zip(NAMES, values, strict=True):
            if name in record.dtype.names:
                record[name] = value
        return functions.step(record, 0, rng)[1]

    try:
        _outcome(step, 1, 2, 0.5, 1.5, True, False)
    except NumbaError as error:
        raise NotCompilable(str(error)) from None
    if refusals:
        raise refusals[0]
    return lambda *values: _outcome(step, *values)


def _outcome(function: Callable[..., Any], *values: Any) -> Any:
    try:
        return function(*values)
    except (ArithmeticError, ValueError, IndexError, KeyError):
        return FAILED


def bits(value: Any) -> Any:
    """Returns what must be equal of a result: its value as the float of a reward. All NaN are equal."""
    number = float(value)
    return "nan" if math.isnan(number) else number.hex()
