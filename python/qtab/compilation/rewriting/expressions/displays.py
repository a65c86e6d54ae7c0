"""Tuples, lists, sets and dicts that are written out, and comprehensions."""

import ast

from qtab.compilation.rewriting.expressions import containers, membership
from qtab.compilation.rewriting.expressions.expressions import Expressions
from qtab.compilation.rewriting.program import tuple_value
from qtab.compilation.rewriting.values import DictKind, Value, constant


class Displays(Expressions):
    """Rewrites tuples, lists, sets, dicts and comprehensions."""

    def _tuple(self, node: ast.Tuple | ast.List) -> Value:
        return self.tuple_of(containers.unpacked(self, node.elts), node, list if isinstance(node, ast.List) else tuple)

    _list = _tuple

    def _set(self, node: ast.Set) -> Value:
        parts = [self.expression(one) for one in node.elts]
        if all(part.is_fixed for part in parts):
            return self.folded(node, lambda *values: set(values), *[part.fixed for part in parts])
        raise self.refuse(node, "a set is made while stepping", "use a tuple or a NumPy array")

    def _dict(self, node: ast.Dict) -> Value:
        if any(key is None for key in node.keys):
            raise self.refuse(node, "a dict is unpacked into another", "write its keys")
        keys = [self.expression(key) for key in node.keys if key is not None]
        parts = [self.expression(one) for one in node.values]
        if not all(key.is_fixed and isinstance(key.fixed, str | int) for key in keys):
            raise self.refuse(node, "a dict with keys that are not constant", "use a NumPy array indexed by integers")
        names = tuple(key.fixed for key in keys)
        if all(part.is_fixed for part in parts):
            return constant(dict(zip(names, (part.fixed for part in parts), strict=True)))
        lifted = tuple_value(tuple(self.lift(part, node) for part in parts))
        return Value(DictKind(names, lifted.kind.items), lifted.code, parts=lifted.parts)

    def _listcomp(self, node: ast.ListComp | ast.GeneratorExp) -> Value:
        return self.tuple_of(membership.comprehension(self, node), node, list)

    _generatorexp = _listcomp
