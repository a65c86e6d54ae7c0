"""Vector environments of users' environments in lock-step: ours beside SyncVectorEnv of the same classes."""

import copy
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import qtab
from support.lockstep.vector import assert_equal, position


def make(name: str, num_envs: int, mode: AutoresetMode = AutoresetMode.NEXT_STEP, **kwargs: Any) -> tuple[Any, Any]:
    """Returns ours, and Gymnasium's SyncVectorEnv of the same environments."""
    own = {key: kwargs.pop(key) for key in ("threads", "copy") if key in kwargs}
    ours = qtab.RustVectorEnv(name, num_envs, autoreset_mode=mode, **own, **kwargs)
    return ours, SyncVectorEnv([lambda: gym.make(name, **kwargs)] * num_envs, autoreset_mode=mode)


def available(space: Any, infos: dict[str, Any], rng: np.random.Generator, num_envs: int) -> Any:
    """Returns a random available action for each sub-environment."""
    masks = infos.get("action_mask", np.ones((num_envs, space.n), np.int8))
    return np.array([int(space.start) + int(rng.choice(np.flatnonzero(row if row.any() else [1]))) for row in masks])


def in_lockstep(ours: Any, theirs: Any, steps: int, seed: int) -> None:
    rng, num_envs = np.random.default_rng(seed), ours.num_envs
    result = theirs.reset(seed=seed)
    assert_equal(ours.reset(seed=seed), result)
    for _ in range(steps):
        actions = available(theirs.single_action_space, result[-1], rng, num_envs)
        result = theirs.step(actions)
        assert_equal(ours.step(actions), result)
        over = result[2] | result[3]
        if ours.autoreset_mode is AutoresetMode.DISABLED and over.any():
            masks = result[-1].get("action_mask")
            again = theirs.reset(options={"reset_mask": over.copy()})
            assert_equal(ours.reset(options={"reset_mask": over.copy()}), again)
            if masks is not None:
                masks[over] = again[-1]["action_mask"][over]


def step_and_reset(ours: Any, theirs: Any, actions: Any) -> None:
    """Takes a step in both, and resets the episodes that are over where nothing else does."""
    assert_equal(ours.step(actions), result := theirs.step(actions))
    over = result[2] | result[3]
    if ours.autoreset_mode is AutoresetMode.DISABLED and over.any():
        options = {"reset_mask": over.copy()}
        assert_equal(ours.reset(options=dict(options)), theirs.reset(options=dict(options)))


def python_continues(name: str, mode: AutoresetMode, num_actions: int, shown: Callable[[Any], Any]) -> tuple[Any, Any]:
    """Accesses the sub-environments within episodes, after which Python steps them; ``shown`` shows their state."""
    ours, theirs = make(name, 5, mode, max_episode_steps=6)
    assert_equal(ours.reset(seed=1), theirs.reset(seed=1))
    for index, row in enumerate(np.random.default_rng(0).integers(0, num_actions, (40, 5))):
        step_and_reset(ours, theirs, row)
        if index == 17:
            assert ours.is_native
            assert [shown(env.unwrapped) for env in ours.envs] == [shown(env.unwrapped) for env in theirs.envs]
            assert not ours.is_native
    return ours, theirs


def step_error_changes_nothing(name: str, threads: int, before: Any, failing: Any, after: Any, message: str) -> Any:
    """Takes a step that raises a ``KeyError`` twice; returns what was raised.

    Args:
        name: The id, of which six copies are made.
        threads: The number of threads.
        before: The actions of the steps before.
        failing: Those of the step.
        after: Those of steps after it, which are the same without it.
        message: The error.
    """
    ours, _ = make(name, 6, threads=threads)
    ours.reset(seed=4)
    for row in before:
        ours.step(row)
    untouched = copy.deepcopy(ours)
    for _ in range(2):
        with pytest.raises(KeyError, match=message) as raised:
            ours.step(failing)
    assert ours.is_native
    for _ in range(5):
        assert_equal(ours.step(after), untouched.step(after))
    return raised


def reset_error_changes_nothing(name: str, mode: AutoresetMode) -> None:
    """Begins episodes that raise an error for an unlucky number, by ``reset`` and after the end of an episode."""
    first, _, third = np.random.default_rng(8).random(3)
    ours, _ = make(name, 3, mode, unlucky=float(first))
    ours.reset(seed=0)
    ours.step([1, 0, 1])
    before = ours.checkpoint()
    with pytest.raises(ValueError, match="no first state"):
        ours.reset(seed=[5, None, 8])
    assert (ours.np_random_seed, ours.checkpoint()) == ((0, 1, 2), before)
    assert ours.is_native

    # The reset after an episode, which draws the third number of the generator.
    ours, theirs = make(name, 3, mode, unlucky=float(third), max_episode_steps=1)
    assert_equal(ours.reset(seed=[0, 8, 1]), theirs.reset(seed=[0, 8, 1]))
    if mode is AutoresetMode.NEXT_STEP:
        assert_equal(ours.step([1, 1, 1]), theirs.step([1, 1, 1]))
    before = ours.checkpoint()
    for _ in range(2):
        with pytest.raises(ValueError, match="no first state"):
            ours.step([1, 1, 1])
        assert ours.checkpoint() == before
    assert ours.is_native


def in_lockstep_with_dummy_vec_env(name: str) -> tuple[Any, Any]:
    """Takes steps in ``qtab.sb3.VecEnv`` and in the vector environment of Stable-Baselines3, and returns both."""
    vec_env = pytest.importorskip("stable_baselines3.common.vec_env")
    ours = qtab.sb3.VecEnv(name, 3, seed=1, max_episode_steps=4)
    theirs = vec_env.DummyVecEnv([lambda: gym.make(name, max_episode_steps=4)] * 3)
    theirs.seed(1)
    assert np.array_equal(ours.reset(), theirs.reset())
    for row in np.random.default_rng(0).integers(0, 3, (40, 3)):
        one, other = ours.step(row), theirs.step(row)
        assert [part.tobytes() for part in one[:3]] == [part.tobytes() for part in other[:3]]
        assert repr(one[3]) == repr(other[3])
    assert ours.venv.is_native
    return ours, theirs


def same_streams(ours: Any, theirs: Any) -> None:
    assert ours.np_random_seed == theirs.np_random_seed
    for one, other in zip(ours.np_random, theirs.np_random, strict=True):
        assert position(one) == position(other)
