"""The functions of ``qtab_env.h`` around the functions of a functional environment."""

import math
from typing import Any

import numpy as np
from numba.core import types

from qtab.compilation.c_functions.addresses import GENERATOR, generator_at
from qtab.compilation.c_functions.compiler import Report, c_functions, returned_type
from qtab.compilation.c_functions.dispatchers import FunctionCompiler
from qtab.compilation.c_functions.memory_access import layout_from, reader, type_of, united, writer
from qtab.compilation.c_functions.observation_writers import mask_writer, observation_writer
from qtab.compilation.c_functions.self_type import self_at, self_type
from qtab.compilation.called_functions import helper_methods, methods_of, names_of, reachable
from qtab.compilation.checks.exact_values import exact_checker
from qtab.compilation.checks.mixed_numbers import Paths, callees, converted
from qtab.compilation.interface.qtab_env import FAILED, TERMINATED
from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.layouts.parameters import Parameters
from qtab.compilation.layouts.value_layout import Array, Layout, Number, Tuple
from qtab.compilation.not_compilable import NotCompilable

MOST_STATE_TYPES = 8
"""The most times that the type of the state may grow."""


def compile_functional(
    env: Any, parameters: Parameters, observation: ObservationLayout, report: Report
) -> tuple[dict[str, Any], Layout]:
    """Compiles a functional environment; returns the compile results of the C functions, and the layout of the state.

    Args:
        env: The environment.
        parameters: The attributes that its functions read.
        observation: The layout of its observations.
        report: Called after each stage.

    Raises:
        NotCompilable: if a value has a type that compiled code cannot pass on.
        numba.core.errors.NumbaError: if Numba does not compile a function.
    """
    compiler = FunctionCompiler()
    own = methods_of(env)
    helpers = helper_methods(type(env), names_of(reachable(env)))
    bound = {name: compiler.method(function, static) for name, (function, static) in helpers.items()}
    given = self_type(parameters, bound)
    functions = {name: compiler.dispatcher(function) for name, function in own.items()}
    example = env.initial_state(np.random.default_rng(0))
    state = _state_layout(functions, given, example)
    report()
    of_state = type_of(state)
    seen = returned_type(functions["observe"], (given, of_state))
    scope: dict[str, Any] = {
        **functions,
        "np": np,
        "isfinite": math.isfinite,
        "generator_at": generator_at,
        "self_at": self_at(given),
        "read_state": reader(state),
        "write_state": writer(state),
        "check_first": exact_checker(returned_type(functions["initial_state"], (given, GENERATOR)), of_state),
        "check_next": exact_checker(
            returned_type(functions["transition"], (given, of_state, types.int64, GENERATOR)).types[0], of_state
        ),
        "write_observation": observation_writer(observation, seen),
        "write_reward": writer(Number(np.dtype(np.float64))),
        "start": int(env.action_space.start),
    }
    if "action_mask" in functions:
        mask = returned_type(functions["action_mask"], (given, of_state))
        scope["write_mask"] = mask_writer(int(env.action_space.n), mask)
    report()
    moved, reward, _ = returned_type(functions["transition"], (given, of_state, types.int64, GENERATOR)).types
    # Numbers that the transition returned need not be read again, for which the processor would wait.
    following = "following" if moved == of_state and not _has_arrays(state) else "read_state(next_address)"
    source = _source("action_mask" in functions, following, isinstance(types.unliteral(reward), types.Float))
    return c_functions(source, scope, report), state


def _has_arrays(layout: Layout) -> bool:
    return isinstance(layout, Array) or (isinstance(layout, Tuple) and any(map(_has_arrays, layout.items)))


def _state_layout(functions: dict[str, Any], given: Any, example: Any) -> Layout:
    """Returns the layout of the states: that of the first ones, until transitions from them return no other type."""
    try:
        layout = layout_from(returned_type(functions["initial_state"], (given, GENERATOR)), example)
        _note_mixed_state(functions, callees.result(functions["initial_state"].py_func.__code__))
        for _ in range(MOST_STATE_TYPES):
            returned = returned_type(functions["transition"], (given, type_of(layout), types.int64, GENERATOR))
            _check_transition(returned)
            following = united(layout, layout_from(returned.types[0], example))
            for one in (layout, layout_from(returned.types[0], example)):
                _note_mixed_state(functions, frozenset(converted(type_of(one), type_of(following))))
            results = callees.result(functions["transition"].py_func.__code__)
            _note_mixed_state(functions, frozenset(path[1:] for path in results if path[:1] == (0,)))
            if following == layout:
                return layout
            layout = following
    except TypeError as error:
        raise NotCompilable(str(error), advice="a state is a number, an array, or a tuple of them") from None
    raise NotCompilable("the type of the state does not settle")


def _note_mixed_state(functions: dict[str, Any], paths: Paths) -> None:
    """Notes the floats of the state that are sometimes integers in Python."""
    for name in ("transition", "observe", "action_mask"):
        if name in functions:
            callees.give(functions[name].py_func.__code__, 1, paths)


def _check_transition(returned: Any) -> None:
    if not isinstance(returned, types.BaseTuple) or len(returned) != 3:
        raise NotCompilable(f"transition returns {returned}, not (state, reward, terminated)")
    _, reward, terminated = map(types.unliteral, returned.types)
    if not isinstance(reward, types.Integer | types.Float | types.Boolean):
        raise NotCompilable(f"transition returns {reward} as the reward, not a number")
    if not isinstance(terminated, types.Boolean):
        raise NotCompilable(f"transition returns {terminated} as terminated, not a boolean")


def _source(masked: bool, following: str, checks_reward: bool) -> str:
    mask = (
        """
    if not write_mask(mask_address, action_mask(self, state), {terminated}):
        return np.int32(FAILED)"""
        if masked
        else ""
    )
    # Python then raises an error that names the function.
    finite = "    if not isfinite(reward):\n        return np.int32(FAILED)\n" if checks_reward else ""
    return f"""
def qtab_reset(parameters, rng, state_address, observation_address, mask_address):
    self = self_at(parameters)
    first = initial_state(self, generator_at(rng))
    check_first(first)
    write_state(state_address, first)
    state = read_state(state_address)
    if not write_observation(observation_address, observe(self, state)):
        return np.int32(FAILED){mask.format(terminated=False)}
    return np.int32(0)

def qtab_step(parameters, rng, state_address, action, next_address, observation_address, reward_address, mask_address):
    self = self_at(parameters)
    following, reward, terminated = transition(self, read_state(state_address), action + start, generator_at(rng))
    check_next(following)
    write_state(next_address, following)
{finite}    write_reward(reward_address, reward)
    state = {following}
    if not write_observation(observation_address, observe(self, state)):
        return np.int32(FAILED){mask.format(terminated="terminated")}
    return np.int32(TERMINATED) if terminated else np.int32(0)

def qtab_observe(parameters, state_address, observation_address, mask_address):
    self = self_at(parameters)
    state = read_state(state_address)
    if not write_observation(observation_address, observe(self, state)):
        return np.int32(FAILED){mask.format(terminated=True)}
    return np.int32(0)
""".replace("FAILED", str(FAILED)).replace("TERMINATED", str(TERMINATED))
