"""Compilation of Python functions together with the plain Python functions that they call."""

import contextlib
from collections.abc import Callable
from types import CellType, FunctionType, ModuleType
from typing import Any

import numba

from qtab.compilation.called_functions import codes, plain
from qtab.compilation.checks.checked_operations import OPTIONS
from qtab.compilation.checks.numba_pass import CheckedCompiler

CHECKED_OPTIONS: dict[str, Any] = {**OPTIONS, "pipeline_class": CheckedCompiler}
"""The options for users' functions."""


class FunctionCompiler:
    """Gives Numba's dispatchers of functions. Plain functions that they use are replaced by dispatchers as well.

    Args:
        unchecked: Whether a function is compiled without checks, because it is not the user's.
    """

    def __init__(self, unchecked: Callable[[FunctionType], bool] = lambda _: False) -> None:
        self._unchecked = unchecked
        self._dispatchers: dict[FunctionType, Any] = {}

    def dispatcher(self, function: FunctionType) -> Any:
        """Returns the dispatcher of a function."""
        if function not in self._dispatchers:
            used: dict[str, Any] = dict(function.__globals__)
            cells = tuple(CellType() for _ in function.__closure__ or ())
            copied = FunctionType(function.__code__, used, function.__name__, function.__defaults__, cells)
            copied.__kwdefaults__ = function.__kwdefaults__
            copied.__qualname__, copied.__module__ = function.__qualname__, function.__module__
            # First, so that functions may call each other and themselves.
            options = OPTIONS if self._unchecked(function) else CHECKED_OPTIONS
            self._dispatchers[function] = numba.njit(**options)(copied)
            names = {name for code in codes(function.__code__) for name in code.co_names}
            for name in names & function.__globals__.keys():
                used[name] = self._replaced(function.__globals__[name])
            for cell, old in zip(cells, function.__closure__ or (), strict=True):
                with contextlib.suppress(ValueError):  # it is empty
                    cell.cell_contents = self._replaced(old.cell_contents)
        return self._dispatchers[function]

    def method(self, function: FunctionType, static: bool) -> Any:
        """Returns a function that calls a method: ``self`` is its first argument."""
        dispatcher = self.dispatcher(function)
        if not static:
            return dispatcher.py_func
        parameters = ", ".join(["self", *function.__code__.co_varnames[: function.__code__.co_argcount]])
        arguments = parameters.partition(", ")[2]
        scope: dict[str, Any] = {"call": dispatcher}
        exec(f"def method({parameters}):\n    return call({arguments})\n", scope)  # noqa: S102
        scope["method"].__defaults__ = function.__defaults__
        return scope["method"]

    def _replaced(self, value: Any) -> Any:
        function = plain(value)
        if function is not None and not isinstance(value, ModuleType):
            return self.dispatcher(function)
        if isinstance(value, list):
            return _as_tuple(value)
        return value


def _as_tuple(value: Any) -> Any:
    """Returns a list as a tuple, since Numba takes no lists from globals. Compiled code cannot change either."""
    return tuple(map(_as_tuple, value)) if isinstance(value, list) else value
