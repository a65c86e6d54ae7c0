"""The compilation of functional environments, with its proof and its file."""

import os
import re
from importlib.util import find_spec
from typing import Any

import numpy as np
from gymnasium import spaces

from qtab.compilation.cache import machine_code
from qtab.compilation.cache.digest import Digest, digest_of, numba_version
from qtab.compilation.cache.store import Store
from qtab.compilation.called_functions import helper_methods, methods_of, names_of, plain, reachable
from qtab.compilation.checks.source_constructs import refuse_constructs
from qtab.compilation.interface.compiled_env import FUNCTIONS, CompiledEnv
from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.layouts.parameters import Parameters
from qtab.compilation.layouts.value_layout import decode, from_json, layout_of, to_json
from qtab.compilation.not_compilable import NotCompilable, NotNow
from qtab.compilation.proof import prove
from qtab.compilation.twins.functional_twin import FunctionalTwin

LEAST_NUMBA = (0, 61)
"""The oldest version of Numba, as in the extra ``numba`` of pyproject.toml."""

_store = Store()


def capsule_of(env: Any) -> Any:
    """Returns the capsule of a functional environment with its present attributes.

    The functions are compiled, unless they were before: by this process, or by another one on this machine. They are
    then compared with Python.

    Raises:
        NotCompilable: if Numba is not installed, the environment cannot be compiled, or compiled code gives other
            numbers than Python.
    """
    compiled, parameters = compiled_env(env)
    return compiled.capsule(parameters.memory())


def compiled_env(env: Any) -> tuple[CompiledEnv, Parameters]:
    """Returns the compiled environment, and its parameters; see :func:`capsule_of`."""
    require_numba()
    if not isinstance(env.action_space, spaces.Discrete):
        raise NotCompilable("the action space is not Discrete", advice="number the actions, with spaces.Discrete(n)")
    observation = ObservationLayout.of(env.observation_space)
    functions = reachable(env)
    parameters = _parameters(env, functions)
    file = methods_of(env)["transition"].__code__.co_filename
    memory = parameters.memory()

    def make() -> tuple[machine_code.MachineCode, dict[str, Any]]:
        return _compile(env, parameters, observation)

    def load(code: machine_code.MachineCode, description: dict[str, Any]) -> CompiledEnv:
        loaded = machine_code.load(code, FUNCTIONS)
        state = from_json(description["state"])
        masked = "action_mask" in methods_of(env)
        return CompiledEnv(loaded, state, observation, int(env.action_space.n), masked)

    def compare(compiled: CompiledEnv) -> None:
        prove(FunctionalTwin(env, compiled, parameters.values), compiled, memory, functions)

    return _store.compiled(_digest(env, parameters), file, memory, make, load, compare), parameters


def require_numba() -> None:
    """Refuses a compilation now if Numba is not installed, too old or disabled.

    Raises:
        NotNow: if Numba is not installed, too old or disabled.
    """
    if not is_installed():
        raise NotNow("Numba is not installed", advice="pip install numba")
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        raise NotNow("NUMBA_DISABLE_JIT is set")
    version = numba_version()
    if tuple(map(int, re.findall(r"\d+", version)[:2])) < LEAST_NUMBA:
        raise NotNow(f"Numba {version} is too old", advice="pip install 'qtab[numba]'")


def is_installed() -> bool:
    """Returns whether Numba is installed, without importing it."""
    try:
        return find_spec("numba") is not None and find_spec("llvmlite") is not None
    except ValueError:  # it was removed from this process
        return False


def state_from(env: Any, compiled: CompiledEnv, memory: bytes) -> Any:
    """Returns the state in memory as the functions in Python take it, with the named tuples of the environment."""
    state = decode(compiled.state, np.frombuffer(memory, np.uint8))
    return _like(env.initial_state(np.random.default_rng(0)), state)


def _like(example: Any, value: Any) -> Any:
    if not isinstance(value, tuple):
        return value
    items = [_like(one, other) for one, other in zip(example, value, strict=True)]
    return type(example)(*items) if hasattr(example, "_fields") else tuple(items)


def _parameters(env: Any, functions: list[Any]) -> Parameters:
    names = names_of(functions)
    methods = helper_methods(type(env), names).keys()
    own = {name for name in names - methods if hasattr(type(env), name) or name in vars(env)}
    return Parameters.of(env, own - {"observation_space", "action_space", "np_random", "state", "metadata", "spec"})


def _digest(env: Any, parameters: Parameters) -> Digest:
    helpers = {name: function for name, (function, _) in helper_methods(type(env), names_of(reachable(env))).items()}
    kinds = {name: repr(layout_of(value)) for name, value in parameters.values.items()}
    spaces_of = [repr(env.observation_space), repr(env.action_space), _bounds(env.observation_space)]
    others = [kinds, parameters.constants, parameters.refused, spaces_of, _state_layout(env)]
    return digest_of({**methods_of(env), **helpers}, others)


def _state_layout(env: Any) -> str:
    """Returns the layout of states, which may depend on values of attributes; a description of the error without it."""
    try:
        return repr(layout_of(env.initial_state(np.random.default_rng(0))))
    except Exception as error:  # the compilation refuses it, or Python raises it at the reset
        return f"{type(error).__name__}: {error}"


def _bounds(space: Any) -> list[Any]:
    layout = ObservationLayout.of(space)
    return [layout.low, layout.high]


def _compile(
    env: Any, parameters: Parameters, observation: ObservationLayout
) -> tuple[machine_code.MachineCode, dict[str, Any]]:
    """Returns the machine code of an environment, and the layout of its states as values of JSON."""
    functions = [one for one in reachable(env) if plain(one) is not None]
    refuse_constructs(functions)
    try:
        env.initial_state(np.random.default_rng(0))
    except Exception as error:  # it is raised again when Python resets the environment
        raise NotNow(f"initial_state raises {type(error).__name__}: {error}") from None
    from qtab.compilation.c_functions import compiler
    from qtab.compilation.c_functions.functional_shims import compile_functional

    description: dict[str, Any] = {}

    def compile_functions(report: compiler.Report) -> dict[str, Any]:
        compiled, state = compile_functional(env, parameters, observation, report)
        description["state"] = to_json(state)
        return compiled

    files = {function.__code__.co_filename for function in functions}
    return compiler.compiled(type(env).__name__, files, compile_functions), description
