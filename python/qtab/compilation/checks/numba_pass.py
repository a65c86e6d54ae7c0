"""Numba's compiler of users' functions, which adds the checks, and whose ``float`` is Python's."""

from typing import Any

import numpy as np
from numba.core import ir
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import FunctionPass, register_pass
from numba.core.errors import ConstantInferenceError
from numba.core.typed_passes import NopythonTypeInference

from qtab.compilation.checks.code_checks import Checks


@register_pass(mutates_CFG=False, analysis_only=False)
class FloatCalls(FunctionPass):  # type: ignore[misc]
    """Replaces calls of ``float`` by those of ``np.float64``: Numba's ``float`` leaves a float32 as it is.

    Calls with a text, such as ``float("nan")``, stay: Numba has no ``np.float64`` of texts.
    """

    _name = "qtab_float_calls"

    def __init__(self) -> None:
        FunctionPass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        """Changes the code of a function; returns whether there were changes."""
        code, made = state.func_ir, 0
        for block in code.blocks.values():
            body: list[Any] = []
            for statement in block.body:
                call: Any = getattr(statement, "value", None)
                if _is_float(code, call):
                    made += 1
                    call.func = ir.Var(block.scope, f"$float64_{made}_{id(state)}", call.loc)
                    double = ir.Global("float64", np.float64, call.loc)
                    code._definitions[call.func.name] = [double]
                    body.append(ir.Assign(double, call.func, call.loc))
                body.append(statement)
            block.body = body
        return made > 0


def _is_float(code: ir.FunctionIR, call: Any) -> bool:
    """Returns whether an expression is a call of ``float`` with something else than a text."""
    if not isinstance(call, ir.Expr) or call.op != "call" or len(call.args) != 1 or call.kws:
        return False
    return _constant(code, call.func) is float and not isinstance(_constant(code, call.args[0]), str)


def _constant(code: ir.FunctionIR, variable: ir.Var) -> Any:
    """Returns the value of a variable that is constant; None for others."""
    try:
        return code.infer_constant(variable)
    except ConstantInferenceError:
        return None


@register_pass(mutates_CFG=False, analysis_only=False)
class CheckedCode(FunctionPass):  # type: ignore[misc]
    """Adds the checks after the types are known."""

    _name = "qtab_checked_code"

    def __init__(self) -> None:
        FunctionPass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        """Changes the code of a function; returns whether there were changes."""
        return Checks(state).run()


class CheckedCompiler(CompilerBase):  # type: ignore[misc]
    """Numba's pipeline with ``FloatCalls`` and ``CheckedCode``."""

    def define_pipelines(self) -> list[Any]:
        """Returns the passes."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        names = [str(getattr(one[0], "__name__", "")) for one in passes.passes]
        passes.add_pass_after(FloatCalls, passes.passes[names.index(NopythonTypeInference.__name__) - 1][0])
        passes.add_pass_after(CheckedCode, NopythonTypeInference)
        passes.finalize()
        return [passes]
