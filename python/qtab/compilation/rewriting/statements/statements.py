"""Statements: each becomes lines of the program, or nothing if a constant decides it."""

import ast
import importlib
from functools import cached_property
from typing import Any

from qtab.compilation.not_compilable import Follows, NotCompilable
from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.expressions.displays import Displays
from qtab.compilation.rewriting.program import tuple_value
from qtab.compilation.rewriting.source.syntax import calls_own_functions, info_names
from qtab.compilation.rewriting.statements import assignments, loops
from qtab.compilation.rewriting.statements.effects import check_pure
from qtab.compilation.rewriting.statements.left_out import is_growing_list, is_info_update
from qtab.compilation.rewriting.statements.order import check_order
from qtab.compilation.rewriting.statements.variables import kept
from qtab.compilation.rewriting.values import INFO, Array, InfoKind, TupleKind, Value, constant, in_words, join

REFUSED = {
    "Try": ("try/except", "test the condition with if"),
    "TryStar": ("try/except", "test the condition with if"),
    "With": ("with", "do it in __init__"),
    "Global": ("an assignment to a global variable", "keep the value in an attribute of the environment"),
    "Nonlocal": (
        "an assignment to a variable of an outer function",
        "keep the value in an attribute of the environment",
    ),
    "Delete": ("del", "leave it out"),
    "FunctionDef": ("a function within a function", "write a method"),
    "ClassDef": ("a class within a function", "define it outside"),
    "AsyncFor": ("an asynchronous loop", "write an ordinary loop"),
}


class Statements(Displays):
    """Rewrites statements."""

    def block(self, statements: list[ast.stmt]) -> bool:
        """Rewrites statements; returns whether the end of the block cannot be reached."""
        return any(self._statement_or_problem(statement) for statement in statements)

    def _statement_or_problem(self, node: ast.stmt) -> bool:
        """Rewrites a statement; one that cannot be compiled is noted, and left out to find further problems."""
        depths = self.indent, self.depth, self.program.depth
        try:
            return self.statement(node)
        except NotCompilable as problem:
            if self.program.phase == "mask":
                raise
            self.indent, self.depth, self.program.depth = depths
            follows = isinstance(problem, Follows) or any(name in problem.reason.split() for name in self.unknown)
            if not follows:
                self.program.problems.append(problem)
            if isinstance(node, ast.Return):  # the type of the result is unknown
                raise Follows(problem.reason, problem.file, problem.line, problem.advice) from None
            names = [one for one in ast.walk(node) if isinstance(one, ast.Name)]
            self.unknown |= {one.id for one in names if isinstance(one.ctx, ast.Store)}
            return False

    def indented(self, statements: list[ast.stmt]) -> bool:
        """Rewrites the statements of a branch or a loop that is decided at run time."""
        self.indent += 1
        self.depth += 1
        self.program.depth += 1
        before, constants = len(self.lines), set(self.fixed)
        ended = self.block(statements)
        if len(self.lines) == before:
            self.emit("pass")
        for name in self.fixed.keys() - constants:  # it is not set if the block is not run
            del self.fixed[name]
        self.indent -= 1
        self.depth -= 1
        self.program.depth -= 1
        return ended

    def may_change_state(self, node: ast.AST) -> bool:
        """Returns whether a statement calls the user's functions or properties."""
        names = {one.attr for one in ast.walk(node) if isinstance(one, ast.Attribute)}
        find = self.program.attributes.find
        return calls_own_functions(node) or any(isinstance(find(name)[0], property) for name in names)

    def statement(self, node: ast.stmt) -> bool:
        """Rewrites a statement; returns whether what follows cannot be reached."""
        kind = type(node).__name__
        if kind in REFUSED:
            raise self.refuse(node, f"{REFUSED[kind][0]} cannot be compiled", REFUSED[kind][1])
        method = getattr(self, f"_do_{kind.lower()}", None)
        if method is None:
            raise self.refuse(node, f"the statement {kind} cannot be compiled", "write it with if, for and while")
        simple = not isinstance(node, ast.If | ast.For | ast.While | ast.Match)
        self.copies_state = simple and self.may_change_state(node)
        self.references, self.changing = [], []
        result: bool = method(node)
        check_order(self, node)
        return result

    def _do_pass(self, _: ast.Pass) -> bool:
        return False

    def _do_expr(self, node: ast.Expr) -> bool:
        if isinstance(node.value, ast.Constant):
            return False
        if is_info_update(self, node.value) or is_growing_list(self, node.value):
            return False
        self.whole = node.value
        value = self.expression(node.value)
        if value.code and (not value.is_fixed or self.has_effects(value)):
            self.emit(value.code, node)
        return False

    @cached_property
    def infos(self) -> set[str]:
        """The names of info dicts, which are left out."""
        return info_names(self.source.node) if self.role in ("reset", "step") else set()

    def _do_assign(self, node: ast.Assign) -> bool:
        assignments.assign(self, node, node.targets, node.value)
        return False

    def _do_annassign(self, node: ast.AnnAssign) -> bool:
        if node.value is not None:
            assignments.assign(self, node, [node.target], node.value)
        return False

    def _do_augassign(self, node: ast.AugAssign) -> bool:
        assignments.augmented(self, node)
        return False

    def _do_import(self, node: ast.Import) -> bool:
        for alias in node.names:
            module = importlib.import_module(alias.name)
            name = alias.asname or alias.name.partition(".")[0]
            self.fixed[name] = constant(module if alias.asname else importlib.import_module(name))
        return False

    def _do_importfrom(self, node: ast.ImportFrom) -> bool:
        if node.level or node.module is None:
            raise self.refuse(node, "a relative import within a method", "import it at the top of the file")
        for alias in node.names:
            module = importlib.import_module(node.module)
            self.fixed[alias.asname or alias.name] = constant(getattr(module, alias.name))
        return False

    def _do_assert(self, node: ast.Assert) -> bool:
        if not __debug__:
            return False
        test = self.test(node.test)
        if test.is_fixed and test.fixed:
            return False
        self.emit("raise AssertionError" if test.is_fixed else f"if not {test.code}:", node)
        if not test.is_fixed:
            self.emit("    raise AssertionError", node)
        return test.is_fixed

    def _do_raise(self, node: ast.Raise) -> bool:
        self.emit("raise RuntimeError", node)
        return True

    def _do_if(self, node: ast.If) -> bool:
        self.copies_state = self.may_change_state(node.test)
        test = self.test(node.test)
        check_order(self, node.test)
        if test.is_fixed:
            return self.block(node.body if test.fixed else node.orelse)
        self.emit(f"if {test.code}:", node)
        before = set(self.flow.assigned)
        ended = self.indented(node.body)
        after_body = before | self.flow.assigned
        self.flow.assigned = set(before)
        other_ended = False
        if node.orelse:
            self.emit("else:", node)
            other_ended = self.indented(node.orelse)
        if ended:
            return other_ended
        self.flow.assigned = after_body if other_ended else after_body & self.flow.assigned
        return False

    def _do_match(self, node: ast.Match) -> bool:
        rest: list[ast.stmt] = []
        for case in reversed(node.cases):
            test = self._case_test(node.subject, case)
            made = case.body if test is None else [ast.copy_location(ast.If(test, case.body, rest), case.body[0])]
            rest = list(made)
        if not isinstance(node.subject, ast.Name | ast.Attribute):
            raise self.refuse(node.subject, "match with an expression", "assign it to a variable first")
        return self.block(rest)

    def _case_test(self, subject: ast.expr, case: ast.match_case) -> ast.expr | None:
        def test(pattern: ast.pattern) -> ast.expr | None:
            match pattern:
                case ast.MatchAs(pattern=None, name=None):
                    return None
                case ast.MatchValue(value=value):
                    made: ast.expr = ast.Compare(subject, [ast.Eq()], [value])
                case ast.MatchOr(patterns=patterns):
                    tests = [one for one in map(test, patterns) if one is not None]
                    if len(tests) < len(patterns):
                        return None
                    made = ast.BoolOp(ast.Or(), tests)
                case _:
                    raise self.refuse(pattern, "a pattern other than a number", "write if and elif")
            return ast.fix_missing_locations(ast.copy_location(made, pattern))

        if case.guard is not None:
            raise self.refuse(case.guard, "a case with a condition", "write if and elif")
        return test(case.pattern)

    def _do_for(self, node: ast.For) -> bool:
        return loops.for_loop(self, node)

    def _do_while(self, node: ast.While) -> bool:
        return loops.while_loop(self, node)

    def _do_break(self, node: ast.Break) -> bool:
        self.flows_at_exit[-1][0].append(set(self.flow.assigned))
        self.emit("break", node)
        return True

    def _do_continue(self, node: ast.Continue) -> bool:
        self.flows_at_exit[-1][1].append(set(self.flow.assigned))
        self.emit("continue", node)
        return True

    def _do_return(self, node: ast.Return) -> bool:
        self.whole = node.value
        if node.value is not None:
            assignments.refuse_iterator(self, node.value)
        value = constant(None) if node.value is None else self._returned(node.value)
        if value.is_fixed and self.has_effects(value):
            self.emit(value.code, node)
        if specials.is_special(value.fixed):
            raise specials.refused_special(self, node, value)
        self.returns.append((value, node, self.depth))
        self.flows_at_return.append(set(self.flow.assigned))
        alone = self.depth == 0 and len(self.returns) == 1
        if value.is_fixed and (alone or value.fixed is None):
            self.emit("return", node)
            return True
        value = self.lift(value, node)
        if isinstance(value.kind, Array) and not value.fresh:
            value = Value(value.kind, f"{value.code}.copy()" if not value.raw else value.code, fresh=True)
        elif value.parts is not None:
            value = tuple_value(tuple(kept(part) for part in value.parts))
        self.emit(f"return {value.code}", node)
        return True

    def _returned(self, node: ast.expr) -> Value:
        """Returns the value that is returned; the info dict of ``reset`` and ``step`` is left out."""
        length = {"reset": 2, "step": 5}.get(self.role)
        if length is None:
            return self.expression(node)
        if isinstance(node, ast.Tuple) and len(node.elts) == length:
            parts = [self.expression(one) for one in node.elts[:-1]]
            last = node.elts[-1]
            if not (isinstance(last, ast.Name) and last.id in self.infos):
                check_pure(self, last)
            self.note_info(last)
            return tuple_value((*[self.lift(part, node) for part in parts], Value(INFO)))
        value = self.expression(node)
        if isinstance(value.kind, TupleKind) and len(value.kind.items) == length:
            if isinstance(value.kind.items[-1], InfoKind):
                return value
            self.emit(f"result = {value.code}", node)
            named = Value(value.kind, "result", views=value.views)
            return tuple_value((*[self.element(named, i) for i in range(length - 1)], Value(INFO)))
        what = "observation, info" if length == 2 else "observation, reward, terminated, truncated, info"
        shown = in_words(value.kind) if value.kind is not None else "something else"
        raise self.refuse(node, f"{self.role} returns {shown}", f"return {what}")

    def note_info(self, node: ast.expr) -> None:
        """Notes the info dict that is returned, for its action mask."""
        self.program.infos.setdefault(self.role, []).append((self, node))

    returns: list[Any]

    def result(self) -> Value:
        """Returns the value that the function returns."""
        if all(value.is_fixed and value.fixed is None for value, _, _ in self.returns):
            return constant(None)
        if len(self.returns) == 1 and self.returns[0][0].is_fixed and self.returns[0][2] == 0:
            return constant(self.returns[0][0].fixed)
        kind: Any = None
        for value, node, _ in self.returns:
            lifted = self.lift(value, node)
            joined = lifted.kind if kind is None else join(kind, lifted.kind)
            if joined is None:
                reason = f"the function returns {in_words(kind)}, and {in_words(lifted.kind)} here"
                raise self.refuse(node, reason, "return the same type everywhere")
            kind = joined
        views = frozenset[str]().union(*(value.views for value, _, _ in self.returns))
        return Value(kind, "", fresh=isinstance(kind, Array) and not views, views=views)
