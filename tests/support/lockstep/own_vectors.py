"""Vector environments of users' environments in lock-step: ours beside SyncVectorEnv of the same classes."""

from typing import Any

import gymnasium as gym
import numpy as np
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


def same_streams(ours: Any, theirs: Any) -> None:
    assert ours.np_random_seed == theirs.np_random_seed
    for one, other in zip(ours.np_random, theirs.np_random, strict=True):
        assert position(one) == position(other)
