"""The functions of ``qtab_env.h`` around the functions of a rewritten class."""

from typing import Any

import numba
import numpy as np
from numba.core import types

from qtab.compilation.c_functions.addresses import GENERATOR, copy_bytes, generator_at, pointer
from qtab.compilation.c_functions.compiler import Report, c_functions, returned_type
from qtab.compilation.c_functions.dispatchers import FunctionCompiler
from qtab.compilation.c_functions.memory_access import writer
from qtab.compilation.c_functions.observation_writers import mask_writer, observation_writer
from qtab.compilation.checks.checked_operations import OPTIONS
from qtab.compilation.interface.qtab_env import FAILED, TERMINATED, TRUNCATED
from qtab.compilation.layouts.attribute_record import OBSERVATION
from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.layouts.value_layout import Number
from qtab.compilation.rewriting import Rewritten
from qtab.compilation.rewriting.helpers import is_helper


def compile_record(
    rewritten: Rewritten,
    record: np.dtype[Any],
    observation: ObservationLayout,
    num_actions: int,
    start: int,
    report: Report,
) -> dict[str, Any]:
    """Compiles a rewritten class, and returns Numba's compile results by the names of the C functions.

    Args:
        rewritten: The functions.
        record: The record with the observation.
        observation: The layout of its observations.
        num_actions: The number of actions.
        start: The first action of the class.
        report: Called after each of ``qtab.compilation.c_functions.functional_shims.STAGES``.

    Raises:
        NotCompilable: if a value has a type that compiled code cannot pass on.
        numba.core.errors.NumbaError: if Numba does not compile a function.
    """
    compiler = FunctionCompiler(unchecked=is_helper)
    of_record = numba.from_dtype(record)
    reset, step = compiler.dispatcher(rewritten.reset), compiler.dispatcher(rewritten.step)  # type: ignore[arg-type]
    seen = returned_type(reset, (of_record, GENERATOR))
    report()
    stepped = returned_type(step, (of_record, types.int64, GENERATOR))
    report()
    fields: Any = record.fields
    scope: dict[str, Any] = {
        "np": np,
        "copy_bytes": copy_bytes,
        "generator_at": generator_at,
        "reset": reset,
        "step": step,
        "record_at": _record_at(record),
        "write_first": observation_writer(observation, seen),
        "write_next": observation_writer(observation, stepped.types[0]),
        "write_reward": writer(Number(np.dtype(np.float64))),
    }
    if rewritten.action_mask is not None:
        mask = compiler.dispatcher(rewritten.action_mask)  # type: ignore[arg-type]
        scope["action_mask"] = mask
        scope["write_mask"] = mask_writer(num_actions, returned_type(mask, (of_record,)))
    numbers = {
        "SIZE": record.itemsize,
        "OFFSET": fields[OBSERVATION][1],
        "BYTES": observation.dtype.itemsize * observation.size,
        "START": start,
        "FAILED": FAILED,
        "TERMINATED": TERMINATED,
        "TRUNCATED": TRUNCATED,
    }
    return c_functions(_source(rewritten.action_mask is not None, numbers), scope, report)


def _record_at(record: np.dtype[Any]) -> Any:
    """Returns a function of an address for compiled code: the record there."""
    carray, at = numba.carray, pointer

    def record_at(address: Any) -> Any:
        return carray(at(address), (1,), record)[0]

    return numba.njit(**OPTIONS)(record_at)


def _source(masked: bool, numbers: dict[str, int]) -> str:
    mask = "    if not write_mask(mask_address, action_mask(record), {ended}):\n        return np.int32(FAILED)\n"
    lines = f"""
def qtab_reset(parameters, rng, state_address, observation_address, mask_address):
    copy_bytes(state_address, parameters, SIZE)
    record = record_at(state_address)
    observation = reset(record, generator_at(rng))
    if not write_first(observation_address, observation):
        return np.int32(FAILED)
    copy_bytes(state_address + OFFSET, observation_address, BYTES)
{mask.format(ended=False) if masked else ""}    return np.int32(0)

def qtab_step(parameters, rng, state_address, action, next_address, observation_address, reward_address, mask_address):
    copy_bytes(next_address, state_address, SIZE)
    record = record_at(next_address)
    observation, reward, terminated, truncated = step(record, action + START, generator_at(rng))
    write_reward(reward_address, reward)
    if not write_next(observation_address, observation):
        return np.int32(FAILED)
    copy_bytes(next_address + OFFSET, observation_address, BYTES)
{mask.format(ended="terminated or truncated") if masked else ""}    ending = 0
    if terminated:
        ending += TERMINATED
    if truncated:
        ending += TRUNCATED
    return np.int32(ending)

def qtab_observe(parameters, state_address, observation_address, mask_address):
    record = record_at(state_address)
    copy_bytes(observation_address, state_address + OFFSET, BYTES)
{mask.format(ended=True) if masked else ""}    return np.int32(0)
"""
    for name, number in numbers.items():
        lines = lines.replace(name, str(number))
    return lines
