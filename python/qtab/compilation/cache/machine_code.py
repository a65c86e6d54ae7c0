"""Machine code: made from compiled functions, and loaded again without Numba."""

import ctypes
import re
from dataclasses import dataclass
from typing import Any

from qtab.compilation.cache.numba_symbols import provide
from qtab.compilation.interface.qtab_env import FAILED

_LIBRARY_CALLS = re.compile(r"llvm\.(exp|exp2|log|log2|log10|pow|sin|cos|tan|fma|floor|ceil|trunc|rint|round)\.f64")
"""Instructions that become calls of C's mathematics."""


@dataclass(frozen=True)
class MachineCode:
    """An object file, and the names that it needs from the process."""

    object_file: bytes
    needed: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class LoadedCode:
    """Machine code in memory, which lives as long as this object."""

    addresses: dict[str, int]
    engine: Any


class CannotLoad(Exception):  # noqa: N818 - the code is compiled again
    """Machine code needs a function that the process does not have."""


def make(functions: dict[str, Any], argument_types: dict[str, str]) -> MachineCode:
    """Returns machine code with a C function for each compiled function.

    A C function returns what the compiled function returns, an int32, or ``FAILED`` if it raises an error.

    Args:
        functions: Numba's compile results, by the names of the C functions.
        argument_types: For each name, a letter for each argument: ``p`` for an address and ``i`` for an int64.

    Raises:
        CannotLoad: if the code refers to objects of this process, such as functions of ctypes.
    """
    from llvmlite import ir
    from numba.core.compiler_lock import global_compiler_lock
    from numba.core.registry import cpu_target

    context = cpu_target.target_context
    with global_compiler_lock:
        library = context.codegen().create_library("qtab_env")
        library.enable_object_caching()
        module = library.create_ir_module("qtab_env")
        integers = {"p": context.get_value_type(_types().uintp), "i": ir.IntType(64)}
        result = ir.IntType(32)
        for name, compiled in functions.items():
            compiled_as = compiled.fndesc
            signature = context.call_conv.get_function_type(compiled_as.restype, compiled_as.argtypes)
            called = ir.Function(module, signature, compiled_as.llvm_func_name)
            arguments = [integers[letter] for letter in argument_types[name]]
            function = ir.Function(module, ir.FunctionType(result, arguments), name)
            builder = ir.IRBuilder(function.append_basic_block("entry"))
            status, value = context.call_conv.call_function(
                builder, called, compiled_as.restype, compiled_as.argtypes, function.args
            )
            with builder.if_then(status.is_error, likely=False):
                builder.ret(ir.Constant(result, FAILED))
            builder.ret(value)
            if compiled.library.has_dynamic_globals:
                raise CannotLoad("the code refers to objects of this process")
        library.add_ir_module(module)
        for compiled in functions.values():
            library.add_linking_library(compiled.library)
        library.finalize()
        library.get_pointer_to_function(next(iter(functions)))  # makes the object file
        return MachineCode(library._get_compiled_object(), _needed(library._final_module))


def load(code: MachineCode, names: tuple[str, ...]) -> LoadedCode:
    """Loads machine code and returns the addresses of its functions.

    Raises:
        CannotLoad: if it needs a function that the process does not have.
    """
    import llvmlite.binding as llvm

    _initialize(llvm)
    # Also those that the process has: which of several functions runs would depend on what was loaded before.
    if not provide(llvm, code.needed) or _missing(llvm, code.needed):
        from numba.core.registry import cpu_target

        _ = cpu_target.target_context  # makes all functions of Numba known
        if missing := _missing(llvm, code.needed):
            raise CannotLoad(f"the process has no function {missing[0]}")
    module = llvm.parse_assembly("")
    module.triple = llvm.get_process_triple()
    machine = llvm.Target.from_triple(module.triple).create_target_machine(jit=True)
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code.object_file))
    engine.finalize_object()
    addresses = {name: engine.get_function_address(name) for name in names}
    if not all(addresses.values()):
        raise CannotLoad("a function is missing")
    return LoadedCode(addresses, engine)


def function_at(prototype: Any, address: int) -> Any:
    """Returns the C function at an address."""
    return ctypes.cast(address, prototype)


def _types() -> Any:
    from numba.core import types

    return types


def _initialize(llvm: Any) -> None:
    for prepare in (llvm.initialize, llvm.initialize_native_target, llvm.initialize_native_asmprinter):
        try:
            prepare()
        except RuntimeError:  # later versions of llvmlite initialize LLVM themselves
            continue


def _needed(module: Any) -> tuple[str, ...]:
    names = set()
    for function in module.functions:
        if function.is_declaration:
            if (call := _LIBRARY_CALLS.fullmatch(function.name)) is not None:
                names.add(call[1])
            elif not function.name.startswith("llvm."):
                names.add(function.name)
    return tuple(sorted(names))


def _missing(llvm: Any, names: tuple[str, ...]) -> list[str]:
    # floor and the like are usually instructions; only the process's own functions can be found.
    return [name for name in names if llvm.address_of_symbol(name) is None]
