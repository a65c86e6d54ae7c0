"""The compilation of the three C functions with Numba, whose errors become those of qtab."""

import logging
import time
import warnings
from collections.abc import Callable, Iterable
from itertools import count
from typing import Any, TypeAlias

import numba
from numba.core import types
from numba.core.errors import NumbaError

from qtab._utils.progress import ProgressBar
from qtab.compilation.cache import machine_code
from qtab.compilation.checks.checked_operations import OPTIONS
from qtab.compilation.checks.mixed_numbers import callees
from qtab.compilation.checks.numba_errors import not_compilable, shortened
from qtab.compilation.checks.typed_code import refusals
from qtab.compilation.not_compilable import NotCompilable, NotNow, combined

ARGUMENTS = {"qtab_reset": "ppppp", "qtab_step": "pppipppp", "qtab_observe": "pppp"}
"""The C functions: ``p`` for an address, ``i`` for an int64."""

STAGES = 2 + len(ARGUMENTS)
"""The number of stages of a compilation: the user's functions, the writers of their results, and the C functions."""

SLOW_SECONDS = 1.0
"""The duration of a compilation above which it is reported."""

Report: TypeAlias = Callable[[], None]
"""Called after each stage. It raises the refusals that the stage has met."""

_logger = logging.getLogger("qtab")


def compiled(name: str, files: Iterable[str], compile_functions: Callable[[Report], Any]) -> machine_code.MachineCode:
    """Returns the machine code of an environment.

    Args:
        name: The name of its class, for messages.
        files: The user's files, whose lines errors name.
        compile_functions: Compiles the C functions, and returns Numba's compile results by their names.

    Raises:
        NotCompilable: if the functions cannot be compiled.
        NotNow: at an internal error of Numba.
        CannotLoad: if the code refers to objects of this process.
    """
    refusals.clear()
    callees.clear()
    started = time.perf_counter()
    with warnings.catch_warnings(), ProgressBar(STAGES, "stage", None, f"compiling {name}") as bar:
        warnings.simplefilter("ignore")

        def functions() -> dict[str, Any]:
            done = count(1)

            def report() -> None:
                bar.move_to(next(done))
                if refusals:
                    raise combined(refusals)

            callees.begin()
            found: dict[str, Any] = compile_functions(report)
            # Functions that were compiled before their callers may receive more than they were checked for.
            return functions() if callees.is_stale else found

        try:
            made = machine_code.make(functions(), ARGUMENTS)
        except NumbaError as error:
            raise not_compilable(error, files) from None
        except (NotCompilable, machine_code.CannotLoad):
            raise
        except Exception as error:  # an internal error of Numba; Python can step the environment
            raise NotNow(f"Numba failed with {type(error).__name__}: {shortened(str(error))}") from None
    seconds = time.perf_counter() - started
    if seconds > SLOW_SECONDS:
        _logger.info("compiled %s in %.1f s", name, seconds)
    return made


def returned_type(dispatcher: Any, arguments: tuple[Any, ...]) -> Any:
    """Compiles a function for types of arguments, and returns the type of its result."""
    dispatcher.compile(arguments)
    return dispatcher.overloads[arguments].signature.return_type


def c_functions(source: str, scope: dict[str, Any], report: Report) -> dict[str, Any]:
    """Compiles the C functions.

    Args:
        source: Their source.
        scope: What it uses.
        report: Called after each.

    Returns:
        Numba's compile results by the names of the C functions.
    """
    exec(source, scope)  # noqa: S102 - code of this package
    made = {}
    for name, letters in ARGUMENTS.items():
        function = numba.njit(**OPTIONS)(scope[name])
        signature = tuple(types.int64 if letter == "i" else types.uintp for letter in letters)
        function.compile(signature)
        made[name] = function.overloads[signature]
        report()
    return made
