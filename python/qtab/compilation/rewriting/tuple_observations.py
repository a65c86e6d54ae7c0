"""Observations of rewritten functions as tuples, so that a step allocates no array for them.

NumPy's arrays are allocated and freed by compiled code too, which takes a fifth of the time of a step of MountainCar.
Where ``reset`` or ``step`` returns a vector of floats that it makes itself, as in ``np.array([x, y], np.float32)``, by
itself or by a method such as ``_get_obs``, compiled code returns its numbers instead.
"""

import ast
import re
from dataclasses import replace
from typing import Any

from qtab.compilation.rewriting.rewrite import Rewritten

MOST_NUMBERS = 32
"""Longer vectors stay arrays."""

_VECTOR = re.compile(r"f_vector_(float32|float64)_(\d+)")
"""The functions that make a vector of their arguments."""
_PREFIX = "o_"
"""Of the names of functions that return tuples; no other name of a program begins with it."""


def with_tuple_observations(rewritten: Rewritten) -> Rewritten:
    """Returns a rewritten class whose ``reset`` and ``step`` return tuples instead of new vectors, where they can."""
    program = _Program(rewritten)
    for name in ("reset", "step"):
        program.replace_observation(name)
    source = "\n".join(program.text) + "\n"
    namespace = {name: value for name, value in rewritten.namespace.items() if name != "__builtins__"}
    exec(compile(source, rewritten.reset.__code__.co_filename, "exec"), namespace)  # noqa: S102 - rewritten code
    mask = rewritten.action_mask and namespace["action_mask"]
    functions = {"reset": namespace["reset"], "step": namespace["step"], "action_mask": mask}
    return replace(rewritten, **functions, lines=program.lines, source=source, namespace=namespace)


class _Program:
    """The lines of a program, to which functions are added."""

    def __init__(self, rewritten: Rewritten) -> None:
        self.text, self.lines = rewritten.source.splitlines(), dict(rewritten.lines)
        body = ast.parse(rewritten.source).body
        self.functions = {node.name: node for node in body if isinstance(node, ast.FunctionDef)}
        self.made: dict[tuple[str, bool], str | None] = {}

    def replace_observation(self, name: str) -> None:
        """Lets ``reset`` or ``step`` call a function that returns the observation as a tuple, if there is one."""
        node = self.functions[name]
        call: Any = next(one.value for one in node.body if isinstance(one, ast.Assign))
        returned: Any = node.body[-1]
        observation = returned.value.elts[0] if isinstance(returned.value, ast.Tuple) else returned.value
        if ast.unparse(observation) == "result[0]" and (made := self.variant(call.func.id, within=True)) is not None:
            self.text[call.lineno - 1] = _renamed(self.text[call.lineno - 1], call.func, made)

    def variant(self, name: str, *, within: bool = False) -> str | None:
        """Returns the name of a function that returns a tuple instead of a vector; None if there is none.

        Args:
            name: The name of a function.
            within: Whether it returns the vector as the first item of a tuple.
        """
        if (name, within) not in self.made:
            self.made[name, within] = None  # for functions that call themselves
            self.made[name, within] = self._new(name, within)
        return self.made[name, within]

    def _new(self, name: str, within: bool) -> str | None:
        node = self.functions.get(name)
        if node is None:
            return None
        if (vector := _VECTOR.fullmatch(name)) is not None:
            dtype, size = vector[1], int(vector[2])
            if within or size > MOST_NUMBERS:
                return None
            numbers = ", ".join(f"np.{dtype}(a{i})" for i in range(size))
            arguments = ", ".join(f"a{i}" for i in range(size))
            self._add([f"def {_PREFIX}{name}({arguments}):", f"    return ({numbers},)"], None)
            return _PREFIX + name
        calls = _observations(node, within)
        made = {call.func.id: self.variant(call.func.id) for call in calls or ()}
        if not made or len(set(made.values())) > 1 or None in made.values():
            return None
        lines = self.text[node.lineno - 1 : node.end_lineno]
        for call in calls or ():
            place = call.lineno - node.lineno
            lines[place] = _renamed(lines[place], call.func, str(made[call.func.id]))
        lines[0] = lines[0].replace(f"def {name}(", f"def {_PREFIX}{name}(", 1)
        self._add(lines, node.lineno)
        return _PREFIX + name

    def _add(self, lines: list[str], copied_from: int | None) -> None:
        """Adds a function, which may be a copy of the one that begins in a line."""
        self.text += ["", ""]
        for i, line in enumerate(lines):
            self.text.append(line)
            if copied_from is not None and copied_from + i in self.lines:
                self.lines[len(self.text)] = self.lines[copied_from + i]


def _observations(node: ast.FunctionDef, within: bool) -> list[Any] | None:
    """Returns the calls whose results a function returns, through a variable or not; None if it returns others."""
    returned = []
    for one in ast.walk(node):
        if isinstance(one, ast.Return):
            value = one.value
            if within:
                value = value.elts[0] if isinstance(value, ast.Tuple) and value.elts else None
            returned.append(value)
    calls: list[ast.expr | None] = [one for one in returned if not isinstance(one, ast.Name)]
    names = {one.id for one in returned if isinstance(one, ast.Name)}
    if names & {one.arg for one in node.args.args}:
        return None
    places = {id(one) for one in returned}
    for one in ast.walk(node):
        if isinstance(one, ast.Assign) and [ast.unparse(target) for target in one.targets] in [
            [name] for name in names
        ]:
            calls.append(one.value)
            places.add(id(one.targets[0]))
    used = [one for one in ast.walk(node) if isinstance(one, ast.Name) and one.id in names]
    if any(id(one) not in places for one in used):
        return None
    if not all(isinstance(one, ast.Call) and isinstance(one.func, ast.Name) for one in calls):
        return None
    return calls


def _renamed(line: str, name: ast.expr, new: str) -> str:
    """Returns a line in which a name is replaced."""
    coded = line.encode()
    return (coded[: name.col_offset] + new.encode() + coded[name.end_col_offset :]).decode()
