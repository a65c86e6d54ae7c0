"""The user's functions as functions of the program, one for each combination of constants and kinds."""

import ast
from dataclasses import replace
from typing import TYPE_CHECKING

from qtab.compilation.not_compilable import Follows, NotCompilable
from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.expressions.containers import has_numbers
from qtab.compilation.rewriting.program import Compiled, Flow, Program
from qtab.compilation.rewriting.scope import LOCAL, Scope
from qtab.compilation.rewriting.source.sources import Source
from qtab.compilation.rewriting.statements.references import returns_new
from qtab.compilation.rewriting.statements.statements import Statements
from qtab.compilation.rewriting.statements.variables import kept
from qtab.compilation.rewriting.values import InfoKind, Scalar, Value, constant, kind_of

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

MAX_ROUNDS = 20
"""How often a function is rewritten until the kinds of its variables stay the same."""


def called(
    scope: "Expressions", node: ast.AST, source: Source, owner: type | None, parameters: dict[str, Value]
) -> Value:
    """Returns the value of a call of a user's function."""
    program = scope.program
    given = {name: _argument(scope, node, value) for name, value in parameters.items()}
    compiled = compiled_function(program, source, owner, given, scope, node)
    for value in given.values():
        scope.note_alias(value, node, compiled)
    if compiled.draws and program.phase == "mask":
        raise scope.refuse(node, "an action mask draws random numbers", "draw in step, and keep the result in self")
    scope.called.append(compiled)
    scope.compiled.uses.add(compiled.name)
    scope.compiled.draws |= compiled.draws
    scope.compiled.changes |= compiled.changes
    if compiled.changes:
        scope.changing.append(node)
    scope.flow.follow(compiled.flow)
    result = compiled.result
    if compiled.trivial and result.is_fixed:
        return constant(result.fixed)
    codes = [value.code for value in given.values() if not value.is_fixed and not isinstance(value.kind, InfoKind)]
    first = ["record", "rng"] if compiled.draws else ["record"]
    code = f"{compiled.name}({', '.join(first + codes)})"
    if not result.is_fixed:
        views = result.views
        if compiled.returns_parameter:
            views = views.union(*(value.views for value in given.values()))
        return Value(result.kind, code, fresh=result.fresh and not views, views=views)
    if result.fixed is None:
        return Value(None, code, fixed=None)
    lifted = scope.lift(constant(result.fixed), node)
    return Value(lifted.kind, f"({code}, {lifted.code})[1]", fresh=result.fresh)


def _argument(scope: "Expressions", node: ast.AST, value: Value) -> Value:
    if value.is_fixed and value.kind is None:
        if value.code:
            raise scope.refuse(node, "a function without a result is an argument", "call it in a statement")
        return value
    if value.is_fixed:
        return constant(value.fixed)
    return replace(kept(value), action=value.action)


def compiled_function(
    program: Program,
    source: Source,
    owner: type | None,
    parameters: dict[str, Value],
    scope: "Expressions | None" = None,
    node: ast.AST | None = None,
) -> Compiled:
    """Returns the function of the program for a user's function."""
    key = program.key(source.function, owner, parameters)
    if key in program.failed:
        raise Follows(f"{source.node.name} cannot be compiled")
    if key in program.functions:
        found = program.functions[key]
        if found is None:
            where = Scope(program, source, owner, parameters, Compiled("", Value()), "") if scope is None else scope
            raise where.refuse(node, f"{source.node.name} calls itself", "write a loop")
        return found
    program.functions[key] = None
    try:
        made = _compiled(program, source, owner, parameters)
    except NotCompilable:
        program.failed.add(key)
        raise
    program.functions[key] = made
    return made


def _compiled(program: Program, source: Source, owner: type | None, parameters: dict[str, Value]) -> Compiled:
    compiled = program.named[program.new_name(source.node.name)]
    compiled.file = source.file
    depth = program.depth
    name = source.node.name
    first = next(iter(parameters.values()), None)
    is_own = owner is not None and first is not None and first.fixed is specials.SELF
    role = name if is_own and name in ("reset", "step") else ""
    rewriter = Statements(program, source, owner, parameters, compiled, role)
    for _ in range(MAX_ROUNDS):
        _rewrite(rewriter, parameters)
        if not rewriter.unstable:
            break
    else:
        raise rewriter.refuse(
            None, f"the types of the variables in {name} cannot be determined", "use one type a variable"
        )
    program.depth = depth
    _finish(rewriter, parameters)
    return compiled


def _rewrite(rewriter: Statements, parameters: dict[str, Value]) -> None:
    rewriter.unstable = False
    rewriter.lines, rewriter.indent, rewriter.depth, rewriter.temporaries = [], 1, 0, 0
    rewriter.returns = []
    rewriter.flow, rewriter.flows_at_return, rewriter.flows_at_exit = Flow(), [], []
    for name in parameters:
        rewriter.note_set(name)
    if rewriter.role:
        rewriter.program.infos.pop(rewriter.role, None)
    rewriter.actions = {name for name, value in parameters.items() if value.action}
    if any(isinstance(one, ast.For | ast.While) for one in ast.walk(rewriter.source.node)):
        rewriter.actions = {name for name in rewriter.actions if rewriter.names.counts[name] == 1}
    rewriter.fixed, rewriter.versions = {}, {}
    for name, value in parameters.items():
        if value.is_fixed and name not in rewriter.dynamic:
            rewriter.fixed[name] = constant(value.fixed)
        elif value.is_fixed:
            lifted = rewriter.lift(constant(value.fixed), rewriter.source.node)
            rewriter.note_kind(name, lifted.kind, rewriter.source.node)
            rewriter.emit(f"v_{name} = {lifted.code}")
        else:
            rewriter.note_kind(name, value.kind, rewriter.source.node)
            rewriter.owned[rewriter.version(name)] = False
    ended = rewriter.block(rewriter.source.node.body)
    if not ended:
        rewriter.returns.append((constant(None), rewriter.source.node.body[-1], 0))
        rewriter.flows_at_return.append(set(rewriter.flow.assigned))


def _may_be_parameter(rewriter: Statements, value: Value) -> bool:
    """Returns whether a value that is returned may share the memory of a parameter."""
    if value.parts is not None:
        return any(_may_be_parameter(rewriter, part) for part in value.parts)
    is_known = value.is_fixed or value.fresh or value.frozen or rewriter.owned.get(value.code, False)
    return not is_known and not isinstance(value.kind, Scalar | InfoKind)


def _note_observations(rewriter: Statements) -> None:
    """Notes the attributes whose memory the observations share that ``reset`` or ``step`` returns."""
    for value, node, _ in rewriter.returns:
        views = value.views if value.parts is None else value.parts[0].views
        if views:
            names = " and ".join(f"self.{name}" for name in sorted(views))
            reason = f"the observation shares memory with {names}, which the next reset changes"
            rewriter.program.shown_views.append((views, rewriter.refuse(node, reason, "write .copy()")))


def _finish(rewriter: Statements, parameters: dict[str, Value]) -> None:
    """Writes the head of a function, once it is known what it uses."""
    compiled = rewriter.compiled
    values = [value for value, _, _ in rewriter.returns]
    fixed_none = [value.is_fixed and value.fixed is None for value in values]
    if any(fixed_none) and not all(fixed_none):
        node = next(node for value, node, _ in rewriter.returns if value.is_fixed and value.fixed is None)
        raise rewriter.refuse(
            node, "the function returns None here, and a value elsewhere", "return a value everywhere"
        )
    result = rewriter.result()
    kind = kind_of(result.fixed) if isinstance(result.fixed, list) else result.kind
    makes_list = has_numbers(kind) and returns_new(rewriter, rewriter.source.function)
    compiled.returns_parameter = not makes_list and any(_may_be_parameter(rewriter, value) for value in values)
    is_named = compiled.returns_parameter or any(rewriter.names.are_shared(node) for _, node, _ in rewriter.returns)
    compiled.result = replace(result, fresh=(result.fresh or makes_list) and not is_named)
    if rewriter.role:
        _note_observations(rewriter)
    always = set.intersection(*rewriter.flows_at_return)
    compiled.flow = Flow({name for name in always if not name.startswith(LOCAL)}, rewriter.flow.read)
    body = rewriter.lines
    compiled.trivial = [line.strip() for line, _ in body] == ["return"]
    if not body:
        compiled.trivial = True
        body = [("    return", 0)]
    names = [
        f"v_{name}" for name, value in parameters.items() if not value.is_fixed and not isinstance(value.kind, InfoKind)
    ]
    first = ["record", "rng"] if compiled.draws else ["record"]
    line = rewriter.source.node.lineno
    compiled.lines = [(f"def {compiled.name}({', '.join(first + names)}):", line), *body]
