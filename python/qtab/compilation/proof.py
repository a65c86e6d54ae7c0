"""The comparison of an environment's compiled functions with the same functions in Python, before the first run."""

import warnings
from dataclasses import dataclass
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.compilation.checks.source_constructs import place_of, suspects
from qtab.compilation.interface.compiled_env import CompiledEnv, Stepper
from qtab.compilation.interface.qtab_env import FAILED, TERMINATED, TRUNCATED
from qtab.compilation.layouts.value_layout import leaves
from qtab.compilation.not_compilable import NotCompilable, NotNow

SEEDS = (0, 1, 2, 3)
STEPS = 2000
"""The steps for each seed."""
LONGEST_EPISODE = 200
"""The steps after which an episode of an even seed is reset; those of odd seeds end only in terminal states."""
FAILED_RESETS = 20
"""The resets that may fail before the first one that does not, as they draw other random numbers."""


@dataclass(frozen=True)
class Difference:
    """The first difference between compiled code and Python."""

    seed: int
    episode: int
    step: int
    """The number of the step in the episode, from 1; 0 for the reset."""
    quantity: str
    compiled: Any
    python: Any

    def __str__(self) -> str:
        return (
            f"with seed {self.seed}, in episode {self.episode}, step {self.step}, {self.quantity} is "
            f"{self.compiled!r} in compiled code and {self.python!r} in Python"
        )


def prove(twin: Any, compiled: CompiledEnv, parameters: NDArray[np.uint8], functions: list[FunctionType]) -> None:
    """Plays episodes in Python and in compiled code with the same seeds and random actions, and compares all numbers.

    Args:
        twin: Steps the environment in Python, as those of ``qtab.compilation.twins`` do.
        compiled: The compiled environment.
        parameters: The parameters.
        functions: The functions of the environment, for the message.

    Raises:
        NotCompilable: at the first difference; it names the numbers, the likely line and what to write instead. Also
            if compiled code changes the parameters, which several runs may share.
        NotNow: if resets fail again and again, so that nothing can be compared.
    """
    before = parameters.tobytes()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        for seed in SEEDS:
            difference = _compare(twin, compiled, parameters, seed)
            if isinstance(difference, Exception):
                name = type(difference).__name__
                raise NotNow(f"no episode can begin, because {name} is raised: {difference}")
            if difference is not None:
                raise _refusal(difference, functions)
            if parameters.tobytes() != before:
                reason, advice = "an array of self is changed", "copy the array first, and return the copy"
                raise NotCompilable(reason, *_place_of_step(functions), advice)


def _compare(
    twin: Any, compiled: CompiledEnv, parameters: NDArray[np.uint8], seed: int
) -> Difference | Exception | None:
    """Returns the first difference, None if there is none, or the exception of a reset, after which nothing follows."""
    rng = np.random.Generator(np.random.PCG64(seed))
    stepper = Stepper(compiled, parameters, np.random.PCG64(seed))
    choose = np.random.default_rng(seed + 1000)
    episode, step, failed_resets = 0, -1, 0
    for _ in range(STEPS):
        if step < 0:
            episode, step = episode + 1, 0
            code, numbers = stepper.reset(), _result(twin.reset, rng)
        else:
            step += 1
            action = _random_action(stepper, compiled, choose)
            code, numbers = stepper.step(action), _result(twin.step, action, rng)
        found = _difference(stepper, compiled, code, numbers, rng)
        if found is not None:
            return Difference(seed, episode, step, *found)
        if code != 0 or (seed % 2 == 0 and step >= LONGEST_EPISODE):
            if code == FAILED:
                # The state in Python may have changed; both start again with equal generators.
                rng.bit_generator.state = stepper.bit_generator.state
                failed_resets += step == 0
                if failed_resets == episode == FAILED_RESETS:
                    failure: Exception = numbers
                    return failure
            step = -1
    return None


def _result(function: Any, *arguments: Any) -> Any:
    try:
        return function(*arguments)
    except Exception as error:  # of the user's code: compiled code must fail as well
        return error


def _random_action(stepper: Stepper, compiled: CompiledEnv, choose: np.random.Generator) -> int:
    if not compiled.has_action_mask:
        return int(choose.integers(0, compiled.num_actions))
    return int(choose.choice(np.flatnonzero(stepper.action_mask)))


def _difference(
    stepper: Stepper, compiled: CompiledEnv, code: int, numbers: Any, rng: np.random.Generator
) -> tuple[str, Any, Any] | None:
    if isinstance(numbers, Exception) or code == FAILED:
        if isinstance(numbers, Exception) and code == FAILED:
            return None
        in_python = f"{type(numbers).__name__}: {numbers}" if isinstance(numbers, Exception) else "no error"
        return "the error", "an error" if code == FAILED else "no error", in_python
    ours, theirs = stepper.bit_generator.state, rng.bit_generator.state
    if ours != theirs:
        return "the state of the generator", _words(ours), _words(theirs)
    for name, offset, leaf in leaves(compiled.state, "state"):
        size = leaf.dtype.itemsize * int(np.prod(getattr(leaf, "shape", ())))
        one, other = (memory[offset : offset + size].view(leaf.dtype) for memory in (stepper.state, numbers["state"]))
        if (found := _first(name, one, other, hasattr(leaf, "shape"))) is not None:
            return found
    if "reward" in numbers:
        if stepper.reward.tobytes() != np.float64(numbers["reward"]).tobytes():
            return "the reward", float(stepper.reward[0]), numbers["reward"]
        flags = TERMINATED * numbers["terminated"] + TRUNCATED * numbers.get("truncated", False)
        if code != flags:
            return "terminated", bool(code & TERMINATED), numbers["terminated"]
    if (found := _first("observation", stepper.observation, numbers["observation"], True)) is not None:
        return found
    if compiled.has_action_mask:
        return _first("action_mask", stepper.action_mask, numbers["action_mask"], True)
    return None


def _first(name: str, one: NDArray[Any], other: NDArray[Any], indexed: bool) -> tuple[str, Any, Any] | None:
    """Returns the first number of two arrays of one dtype whose bytes differ, with its name; None without any.

    All NaN are equal: their signs depend on the processor, and compiled code refuses or repeats what reads them.
    """
    if one.tobytes() == other.tobytes():
        return None
    for index in range(len(one)):
        are_nan = one[index] != one[index] and other[index] != other[index]
        if one[index].tobytes() != other[index].tobytes() and not are_nan:
            return f"{name}[{index}]" if indexed else name, one[index].item(), other[index].item()
    return None


def _words(state: Any) -> str:
    return hex(state["state"]["state"] % 2**32)


def _refusal(difference: Difference, functions: list[FunctionType]) -> NotCompilable:
    places = suspects(functions)
    if places:
        likely = places[0]
        others = "".join(f"; line {place.line}: {place.advice}" for place in places[1:4])
        return NotCompilable(
            f"{difference}, probably by {likely.text}", likely.file, likely.line, likely.advice + others
        )
    file, line = _place_of_step(functions)
    advice = "integers beyond 64 bits, float32 and the order of sums can differ"
    return NotCompilable(str(difference), file, line, advice)


def _place_of_step(functions: list[FunctionType]) -> tuple[str, int]:
    return place_of(next(one for one in functions if one.__name__ in ("transition", "step")))
