"""From an environment to functions over a record of its attributes."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab.compilation.not_compilable import Follows, NotCompilable, combined
from qtab.compilation.rewriting import helpers, specials
from qtab.compilation.rewriting.attributes import Attributes, Restart
from qtab.compilation.rewriting.infos.changed import check_changed_infos
from qtab.compilation.rewriting.infos.masks import add_action_mask
from qtab.compilation.rewriting.infos.shown import Shown, shown_of
from qtab.compilation.rewriting.observations import observation_code
from qtab.compilation.rewriting.program import STALE, Compiled, Program, as_float
from qtab.compilation.rewriting.source.sources import Source, source_of
from qtab.compilation.rewriting.source.syntax import parameters_of
from qtab.compilation.rewriting.user_functions import called, compiled_function
from qtab.compilation.rewriting.values import BOOL, INT, Scalar, TupleKind, Value, constant, in_words
from qtab.compilation.twins.class_twin import reset_twin

MAX_ATTEMPTS = 200
SPECIAL_METHODS = ("__getattr__", "__getattribute__", "__setattr__", "__delattr__")


@dataclass(frozen=True, eq=False)
class Rewritten:
    """A Gymnasium class as plain functions over a record of its numbers.

    ``record`` is one element of a structured array of ``dtype``, and is changed in place; ``rng`` is a
    ``numpy.random.Generator``. An exception means that the class would have raised one too, except that an integer may
    have left its range, or an array may have changed its shape.
    """

    reset: Callable[..., Any]
    """``reset(record, rng) -> observation``"""
    step: Callable[..., Any]
    """``step(record, action, rng) -> (observation, reward, terminated, truncated)``.

    Actions count from ``action_space.start``, as in the class. Observations are numbers or arrays; those of Tuple and
    Dict spaces are tuples in the order of the space."""
    action_mask: Callable[..., Any] | None
    """``action_mask(record) -> array of booleans or numbers``, from ``action_masks()`` or the info dict; None without
    masks."""
    mask_refusal: NotCompilable | None
    """Why the action mask of the class cannot be compiled; None if it can, or if the class has none."""
    dtype: np.dtype[Any]
    """The record: the attributes that steps and resets use and change."""
    initial: NDArray[Any]
    """(1,): the record before the first reset."""
    kept_between_episodes: tuple[str, ...]
    """The attributes that change, and that ``reset`` does not assign before it reads them: the first state of an
    episode depends on the episodes before."""
    used: frozenset[str]
    """The attributes that ``reset`` or ``step`` may read or assign, and the spaces."""
    changed: frozenset[str]
    """The attributes that ``reset`` or ``step`` assigns or changes in place, and that compiled code needs."""
    changed_in_place: frozenset[str]
    """Those of which elements are assigned."""
    lines: dict[int, tuple[str, int]]
    """For each line of ``source`` the file and the line of the class."""
    source: str
    """The functions as a module, without imports except of NumPy and ``math``."""
    namespace: dict[str, Any] = field(repr=False)
    """The globals of the functions."""
    shown: Shown = field(default_factory=Shown)
    """What a vector environment shows of the class."""


def rewrite(env: gym.Env, sharing: Mapping[str, str] | None = None) -> Rewritten:
    """Returns an ordinary Gymnasium class as functions over a record of its attributes.

    ``env`` is not changed: a copy of it is reset to see the types of its attributes.

    Args:
        env: The environment, without wrappers.
        sharing: The attributes that share memory in the environment of which ``env`` is a copy, and what with.

    Raises:
        NotCompilable: for what cannot be compiled, with the file, the line and what to write instead.
    """
    _check(env)
    try:
        twin = reset_twin(env)
    except Exception as error:
        kind = type(error).__name__
        raise NotCompilable(f"a copy of the environment cannot be reset ({kind}: {error})") from error
    attributes = Attributes(env, twin, sharing)
    for _ in range(MAX_ATTEMPTS):
        try:
            return _attempt(env, attributes)
        except Restart:
            continue
        except RecursionError:
            raise NotCompilable("the class is nested too deeply", advice="write smaller expressions") from None
        except NotCompilable:
            raise
        except Exception as error:  # of this package; Python can step the environment
            reason = f"{type(env).__name__} is not understood ({type(error).__name__}: {error})"
            raise NotCompilable(reason, advice="train it with backend='gymnasium'") from error
    raise NotCompilable("the types of the attributes cannot be determined", advice="give each attribute one type")


def _check(env: gym.Env) -> None:
    cls = type(env)
    if isinstance(env, gym.Wrapper):
        raise NotCompilable(f"{cls.__name__} is a wrapper", advice="pass the environment without this wrapper")
    if not isinstance(env.action_space, spaces.Discrete):
        space = type(env.action_space).__name__
        raise NotCompilable(f"the action space is a {space}", advice="use a Discrete action space")
    for base in cls.__mro__[: cls.__mro__.index(gym.Env)]:
        for name in SPECIAL_METHODS:
            if name in vars(base):
                raise NotCompilable(f"{base.__name__} defines {name}", advice="use ordinary attributes")
    for name in ("reset", "step"):
        if name in getattr(env, "__dict__", {}):
            raise NotCompilable(f"{name} was replaced on the object", advice="define it in the class")


def _attempt(env: gym.Env, attributes: Attributes) -> Rewritten:
    program = Program(env, attributes)
    try:
        return _rewritten(env, attributes, program)
    except Restart:
        raise
    except Exception:
        if program.problems:  # the error follows from them
            raise combined(program.problems) from None
        raise


def _rewritten(env: gym.Env, attributes: Attributes, program: Program) -> Rewritten:
    program.compile_call = called
    for name in helpers.HELPERS:
        program.named[name] = Compiled(name, Value())
    try:
        reset = _method(program, "reset")
    except Follows:  # to find the problems of step as well
        _method(program, "step")
        raise
    program.stale_in_reset = {name.removeprefix(STALE) for name in reset.flow.assigned if name.startswith(STALE)}
    step = _method(program, "step")
    for name in program.changed_objects():
        attributes.note_read(name)
    _add_top(program, "reset", reset)
    _add_top(program, "step", step)
    draws = reset.draws or step.draws
    if draws and not program.seeded:
        file, line = reset.file, reset.lines[0][1]
        reason = "the environment draws random numbers, but reset does not seed the generator"
        raise NotCompilable(reason, file, line, "call super().reset(seed=seed) first in reset")
    check_changed_infos(program)
    mask_refusal, tops = None, ["reset", "step"]
    try:
        if add_action_mask(program):
            tops.append("action_mask")
    except NotCompilable as error:
        mask_refusal = error
    if program.problems:
        raise combined(program.problems)
    attributes.check_sharing()
    program.check_aliases()
    source, lines = program.source(tops)
    dtype, initial = attributes.record()
    namespace: dict[str, Any] = {"__name__": "qtab_rewritten", "np": np, **helpers.HELPERS}
    exec(compile(source, f"<{type(env).__name__}>", "exec"), namespace)  # noqa: S102
    mask = namespace.get("action_mask")
    changing = program.stored & attributes.kinds.keys()
    kept = sorted(changing & reset.flow.read | changing - reset.flow.assigned)
    return Rewritten(
        namespace["reset"],
        namespace["step"],
        mask,
        mask_refusal,
        dtype,
        initial,
        tuple(kept),
        frozenset(attributes.read | attributes.assigned) | {"action_space", "observation_space"},
        frozenset(program.stored | attributes.changed_in_place),
        frozenset(attributes.changed_in_place),
        lines,
        source,
        namespace,
        shown_of(program, {"reset": reset, "step": step}, mask_refusal),
    )


def _method(program: Program, name: str) -> Compiled:
    """Returns a method of the environment as a function of the program."""
    program.phase = name
    member, owner = program.attributes.find(name)
    if not isinstance(member, FunctionType) or owner is gym.Env:
        raise NotCompilable(f"{type(program.env).__name__} has no ordinary method {name}", advice=f"define {name}")
    if hasattr(member, "__wrapped__"):
        file, line = member.__code__.co_filename, member.__code__.co_firstlineno
        raise NotCompilable(f"{name} is not an ordinary function", file, line, "remove its decorators")
    source = source_of(member)
    arguments = source.node.args
    names = parameters_of(source.node)
    values: dict[str, Value] = {names[0]: constant(specials.SELF)}
    for one in names[1:]:
        if name == "step" and one == names[1]:
            values[one] = Value(INT, f"v_{one}", action=True)
        elif name == "reset" and one == "seed":
            values[one] = constant(specials.SEED)
        else:
            values[one] = _default(source, one, name)
    if arguments.vararg:
        values[arguments.vararg.arg] = constant(())
    if arguments.kwarg:
        values[arguments.kwarg.arg] = constant({})
    return compiled_function(program, source, owner, values)


def _default(source: Source, parameter: str, method: str) -> Value:
    default = inspect.signature(source.function).parameters[parameter].default
    if default is inspect.Parameter.empty and parameter == "options":
        return constant(None)
    if default is inspect.Parameter.empty:
        advice = f"give {parameter} a default"
        raise NotCompilable(f"{method} has a parameter without default", source.file, source.node.lineno, advice)
    return constant(default)


def _add_top(program: Program, name: str, method: Compiled) -> None:
    """Adds the function of a method: it returns the observation and, for ``step``, the other results."""
    kind = method.result.kind

    def refuse(reason: str, advice: str) -> NotCompilable:
        lines = [origin for line, origin in method.lines if line.strip().startswith("return") and origin]
        return NotCompilable(reason, method.file, lines[-1] if lines else method.lines[0][1], advice)

    length = 2 if name == "reset" else 5
    if not isinstance(kind, TupleKind) or len(kind.items) != length:
        what = "observation, info" if length == 2 else "observation, reward, terminated, truncated, info"
        raise refuse(f"{name} returns something else", f"return {what}")
    program.named[name] = Compiled(name, Value(), uses={method.name})
    code = observation_code(program.env.observation_space, kind.items[0], "result[0]", refuse)
    rng = ["rng"] if method.draws else []
    if name == "reset":
        call = f"{method.name}({', '.join(['record', *rng])})"
        lines = ["def reset(record, rng):", f"    result = {call}", f"    return {code}"]
    else:
        for i, what in ((1, "reward"), (2, "terminated"), (3, "truncated")):
            item = kind.items[i]
            if not isinstance(item, Scalar) or (item != BOOL and i > 1):
                raise refuse(
                    f"{what} is {in_words(item)}", "return a number" if i == 1 else "return a boolean: bool(...)"
                )
        call = f"{method.name}({', '.join(['record', *rng, 'action'])})"
        reward = as_float(Value(kind.items[1], "result[1]"))
        results = f"{code}, {reward}, bool(result[2]), bool(result[3])"
        lines = ["def step(record, action, rng):", f"    result = {call}", f"    return {results}"]
    program.named[name].lines = [(line, 0) for line in lines]
