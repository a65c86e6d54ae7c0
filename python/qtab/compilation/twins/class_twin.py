"""Copies of an environment that are stepped in Python with any generator, and leave the environment as it is."""

import copy
import warnings
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.compilation.layouts.attribute_record import state_bytes
from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.twins.plain_data import is_plain, mutable_parts, same

LARGE = 1 << 20
"""The bytes from which an array is shared by the copies of an environment, which cannot write into it."""


def twin_of(env: gym.Env) -> Any:
    """Returns a copy of an environment, without a call of its methods.

    Attributes that are data are copied, except for large arrays that no method assigns elements of: the copy has views
    of them that are read-only. Other objects, such as windows and files, are shared: they must not be used.
    """
    twin = object.__new__(type(env))
    known = _views_of_large_arrays(env)
    for name, value in vars(env).items():
        vars(twin)[name] = copy.deepcopy(value, known) if is_plain(value) else value
    return twin


def _views_of_large_arrays(env: gym.Env) -> dict[int, Any]:
    """Returns read-only views of the large arrays that no method assigns elements of, by the ids of the arrays."""
    plain = [(name, value) for name, value in vars(env).items() if is_plain(value)]
    large = [
        (name, part)
        for name, value in plain
        for part in mutable_parts(value)
        if isinstance(part, np.ndarray) and part.nbytes >= LARGE
    ]
    if not large:
        return {}
    from qtab.compilation.rewriting.attributes import Attributes

    changed = Attributes(env, env).assigned
    views = {id(part): part.view() for name, part in large if name not in changed}
    for view in views.values():
        view.flags.writeable = False
    return views


@contextmanager
def restored(shared: Sequence[Any]) -> Iterator[None]:
    """Restores lists, dicts, sets, deques and arrays that are changed meanwhile.

    Args:
        shared: The values, which are data.

    Raises:
        NotCompilable: if one of them was changed.
    """
    before = copy.deepcopy(list(shared))
    try:
        yield
    finally:
        changed = [(one, old) for one, old in zip(shared, before, strict=True) if not same(one, old)]
        for value, old in changed:
            _restore(value, old)
    if changed:
        kind = type(changed[0][0]).__name__
        raise NotCompilable(f"a {kind} outside of the environment is changed", advice="keep what changes in self")


def _restore(value: Any, old: Any) -> None:
    if isinstance(value, np.ndarray):
        value[...] = old
    elif isinstance(value, list):
        value[:] = old
    elif isinstance(value, deque):
        value.clear()
        value.extend(old)
    else:
        value.clear()
        value.update(old)


class ClassTwin:
    """Steps a copy of an environment in Python.

    Args:
        env: The environment.
        record: The record with the observation.
        observation: The layout of its observations.
        has_masks: Whether its action masks are compiled. They are not computed otherwise.
    """

    def __init__(
        self, env: gym.Env, record: np.dtype[Any], observation: ObservationLayout, has_masks: bool = True
    ) -> None:
        self.env: Any = twin_of(env)
        self.record, self.observation = record, observation
        space: Any = env.action_space
        self.num_actions, self._start = int(space.n), int(space.start)
        self._has_masks = has_masks
        self.info: Any = None
        """The last info dict."""
        self.mask: Any = None
        """The action mask of the last observation, as it was given; None without one."""

    def reset_class(self, rng: np.random.Generator) -> Any:
        """Resets the copy with a generator, and returns the observation."""
        self.env._np_random = rng
        observation, self.info = self.env.reset()
        return observation

    def step_class(self, action: int, rng: np.random.Generator, number: type[int | np.int64] = int) -> Any:
        """Takes an action, counted from 0 and passed on as a number of a type, and returns what ``step`` does."""
        self.env._np_random = rng
        stepped = self.env.step(number(self._start + action))
        self.info = stepped[4]
        return stepped

    def reset(self, rng: np.random.Generator) -> dict[str, Any]:
        """Resets the copy, and returns the numbers by their names."""
        return self._numbers(self.reset_class(rng), False)

    def step(self, action: int, rng: np.random.Generator) -> dict[str, Any]:
        """Takes an action, counted from 0, and returns the numbers by their names."""
        observation, reward, terminated, truncated, _ = self.step_class(action, rng)
        flags = {"terminated": bool(terminated), "truncated": bool(truncated)}
        return {"reward": float(reward), **flags, **self._numbers(observation, any(flags.values()))}

    def observed(self, given: Any, with_mask: bool = True) -> dict[str, Any]:
        """Returns the numbers of an observation by their names, and those of the action mask if there is one."""
        numbers = {"observation": self.observation.numbers(_in_order(self.env.observation_space, given))}
        self.mask = None
        if with_mask and self._has_masks:
            self.mask = self.env.action_masks() if hasattr(self.env, "action_masks") else self.info.get("action_mask")
        if self.mask is not None:
            numbers["action_mask"] = np.asarray(self.mask).astype(np.uint8)
        return numbers

    def _numbers(self, given: Any, ended: bool) -> dict[str, Any]:
        numbers = self.observed(given)
        if self.mask is not None and (wrong := wrong_mask(self.mask, self.num_actions, ended)) is not None:
            raise ValueError(f"the action mask must {wrong}, got {self.mask!r}")
        return {"state": state_bytes(self.record, self.env, numbers["observation"]), **numbers}


def wrong_mask(mask: Any, num_actions: int, ended: bool = False) -> str | None:
    """Returns what an action mask must be and is not, in words; None for a valid one.

    Args:
        mask: The mask, as the environment gives it.
        num_actions: The number of actions.
        ended: Whether the episode has ended, so that no action need be left.
    """
    given = np.asarray(mask)
    if given.shape != (num_actions,):
        return f"have shape ({num_actions},), with an item for each action"
    if not np.isin(given, (0, 1)).all():
        return "hold booleans, or 0 and 1"
    return None if ended or given.any() else "leave at least one action"


def _in_order(space: Any, given: Any) -> Any:
    """Returns an observation with the keys of dicts in the order of their spaces."""
    if isinstance(space, gym.spaces.Dict):
        return {key: _in_order(inner, given[key]) for key, inner in space.spaces.items()}
    if isinstance(space, gym.spaces.Tuple):
        return tuple(_in_order(inner, part) for inner, part in zip(space.spaces, given, strict=True))
    return given


def reset_twin(env: gym.Env) -> Any:
    """Returns a copy of an environment after a reset with seed 0."""
    twin = twin_of(env)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        twin.reset(seed=0)
    return twin
