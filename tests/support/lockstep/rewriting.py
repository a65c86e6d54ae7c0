"""Ordinary Gymnasium classes and their rewritten functions, step by step."""

import copy
import dataclasses
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding

from qtab.compilation.rewriting import Rewritten
from qtab.compilation.rewriting.helpers import is_helper


def assert_equal_observation(space: gym.Space[Any], expected: Any, found: Any) -> None:
    if isinstance(space, spaces.Dict | spaces.Tuple):
        parts: Any = space.spaces.items() if isinstance(space, spaces.Dict) else enumerate(space.spaces)
        for (key, inner), part in zip(parts, found, strict=True):
            assert_equal_observation(inner, expected[key], part)
    elif isinstance(expected, np.ndarray):
        assert expected.dtype == found.dtype
        assert expected.shape == found.shape
        assert expected.tobytes() == found.tobytes(), (expected, found)
    else:
        assert isinstance(found, int)
        assert expected == found


def assert_equal_state(env: Any, record: Any) -> None:
    for name in record.dtype.names:
        if name == "unused":
            continue
        attribute, _, index = name.partition(".")
        value = getattr(env, attribute)
        for one in index.split(".") if index else ():
            value = value[int(one)]
        assert np.asarray(value, record.dtype[name].base).tobytes() == np.asarray(record[name]).tobytes(), name


def assert_nothing_refused() -> None:
    from qtab.compilation.checks.typed_code import refusals

    assert refusals == []


def assert_equal_steps(
    env: gym.Env, rewritten: Rewritten, steps: int, seed: int = 0, masks: Callable[[Any], Any] | None = None
) -> int:
    """Runs a copy of a class and its functions with random actions; returns the number of episodes that ended."""
    twin: Any = copy.deepcopy(env)
    chooser = np.random.default_rng(seed)
    rng, _ = seeding.np_random(seed)
    record = rewritten.initial.copy()[0:1][0]
    expected, info = twin.reset(seed=seed)
    assert_equal_observation(env.observation_space, expected, rewritten.reset(record, rng))
    space: Any = env.action_space
    ended = 0
    for _ in range(steps):
        if rewritten.action_mask is not None:
            mask = masks(twin) if masks is not None else info["action_mask"]
            assert np.array_equal(mask, rewritten.action_mask(record))
        action = int(chooser.integers(space.n) + space.start)
        expected, reward, terminated, truncated, info = twin.step(action)
        found = rewritten.step(record, action, rng)
        assert_equal_observation(env.observation_space, expected, found[0])
        assert np.float64(reward).tobytes() == np.float64(found[1]).tobytes(), (reward, found[1])
        assert (bool(terminated), bool(truncated)) == found[2:]
        assert_equal_state(twin, record)
        if terminated or truncated:
            ended += 1
            expected, info = twin.reset()
            assert_equal_observation(env.observation_space, expected, rewritten.reset(record, rng))
    assert str(rng.bit_generator.state) == str(twin.np_random.bit_generator.state)
    return ended


def compiled_with_checks(rewritten: Rewritten) -> Rewritten:
    """Returns the same functions, compiled by Numba with the checks of qtab, so that Python can call them.

    They are compiled when they are called; ``qtab.compilation.checks.typed_code.refusals`` lists what is refused.
    """
    import numba

    from qtab.compilation.checks.numba_pass import CheckedCompiler
    from qtab.compilation.checks.typed_code import refusals

    refusals.clear()
    namespace = dict(rewritten.namespace)
    exec(compile(rewritten.source, "<rewritten>", "exec"), namespace)  # noqa: S102
    for name, value in list(namespace.items()):
        if name.startswith(("h_", "f_", "t_")) or name in ("reset", "step", "action_mask"):
            with_globals = type(value)(value.__code__, namespace, value.__name__, value.__defaults__)
            checks = {} if is_helper(value) else {"pipeline_class": CheckedCompiler}
            namespace[name] = numba.njit(error_model="python", boundscheck=True, **checks)(with_globals)
    return dataclasses.replace(
        rewritten,
        reset=namespace["reset"],
        step=namespace["step"],
        action_mask=namespace.get("action_mask"),
        namespace=namespace,
    )
