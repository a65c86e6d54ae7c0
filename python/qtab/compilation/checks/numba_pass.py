"""Numba's compiler of users' functions, which adds the checks."""

from typing import Any

from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import FunctionPass, register_pass
from numba.core.typed_passes import NopythonTypeInference

from qtab.compilation.checks.code_checks import Checks


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
    """Numba's pipeline with ``CheckedCode``."""

    def define_pipelines(self) -> list[Any]:
        """Returns the passes."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(CheckedCode, NopythonTypeInference)
        passes.finalize()
        return [passes]
