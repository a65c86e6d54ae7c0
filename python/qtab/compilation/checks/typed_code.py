"""The code of a function in Numba's representation, whose types are known, and changes to it."""

import linecache
from typing import Any

from numba.core import ir, types

from qtab.compilation.not_compilable import NotCompilable

refusals: list[NotCompilable] = []
"""The constructs that the compilation in progress has met and that are refused."""


class TypedCode:
    """The code of one function.

    Args:
        state: The state of Numba's compiler.
    """

    def __init__(self, state: Any) -> None:
        self.state, self.typemap, self.calltypes = state, state.typemap, state.calltypes
        self.definitions = {
            statement.target.name: statement.value
            for block in state.func_ir.blocks.values()
            for statement in block.body
            if isinstance(statement, ir.Assign)
        }
        self.made = 0

    def definition(self, value: Any) -> Any:
        """Returns what a variable is, through assignments of other variables."""
        while isinstance(value, ir.Var):
            value = self.definitions.get(value.name)
        return value

    def constant(self, variable: Any) -> Any:
        """Returns the value of a variable that is a constant or a global; None for others."""
        found = self.definition(variable)
        return found.value if isinstance(found, ir.Const | ir.Global | ir.FreeVar) else None

    def type_of(self, variable: Any) -> Any:
        """Returns the type of a variable."""
        return self.typemap[variable.name]

    def refuse(self, expression: Any, reason: str, advice: str) -> list[Any]:
        """Notes that an expression is refused; returns no statements."""
        file, line = expression.loc.filename, expression.loc.line
        source = linecache.getline(file, line).strip()
        shown = f", in `{source[:80]}`" if source else ""
        refusals.append(NotCompilable(reason + shown, file, line, advice))
        return []

    def replace(self, statement: Any, scope: Any, helper: Any, arguments: list[Any], of: list[Any] | None) -> list[Any]:
        """Replaces an expression by a call of a helper; returns the statement that defines the helper."""
        kinds = of or [types.unliteral(self.type_of(one)) for one in arguments]
        define, call = self._call_of(helper, scope, list(arguments), (), tuple(kinds), {}, statement.value.loc)
        statement.value = call
        return [define]

    def check_arguments(self, expression: Any, scope: Any, helper: Any) -> list[Any]:
        """Returns the statements that call a helper with the arguments of a call."""
        return self.check(helper, scope, list(expression.args), expression.loc, tuple(expression.kws))

    def check(self, helper: Any, scope: Any, arguments: list[Any], loc: Any, named: Any = ()) -> list[Any]:
        """Returns the statements that call a helper."""
        kinds = tuple(types.unliteral(self.type_of(one)) for one in arguments)
        named_kinds = {name: types.unliteral(self.type_of(one)) for name, one in named}
        define, call = self._call_of(helper, scope, arguments, named, kinds, named_kinds, loc)
        return [define, ir.Assign(call, self._variable(scope, types.none, loc), loc)]

    def _call_of(
        self, helper: Any, scope: Any, arguments: list[Any], named: Any, kinds: Any, named_kinds: Any, loc: Any
    ) -> tuple[Any, Any]:
        of = types.Dispatcher(helper)
        variable = self._variable(scope, of, loc)
        call = ir.Expr.call(variable, arguments, named, loc)
        self.calltypes[call] = of.get_call_type(self.state.typingctx, kinds, named_kinds)
        return ir.Assign(ir.Global(variable.name, helper, loc), variable, loc), call

    def _variable(self, scope: Any, of: Any, loc: Any) -> Any:
        self.made += 1
        variable = ir.Var(scope, f"$qtab{self.made}.{id(self)}", loc)
        self.typemap[variable.name] = of
        return variable
