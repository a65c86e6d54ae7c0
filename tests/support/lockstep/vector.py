"""Vector environments in lock-step: ours beside a SyncVectorEnv of Gymnasium's own environments."""

import copy
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import qtab
from support.lockstep import classic_control, toy_text
from support.processes.machine import MACHINE

IDS = [*classic_control.IDS, "CartPole-v0", *toy_text.IDS]
MODES = list(AutoresetMode)


def ours(name: str, num_envs: int, **kwargs: Any) -> Any:
    """Returns SyncVectorEnv's equal. Of CartPole, ``make_vec`` makes the equal of Gymnasium's CartPoleVectorEnv."""
    if name.startswith("CartPole"):
        return qtab.RustVectorEnv(name, num_envs, **kwargs)
    return gym.make_vec(f"qtab/{name}", num_envs=num_envs, **kwargs)


def theirs(name: str, num_envs: int, mode: AutoresetMode = AutoresetMode.NEXT_STEP, **kwargs: Any) -> SyncVectorEnv:
    first = gym.make(name, **kwargs)
    table = getattr(first.unwrapped, "P", None)
    # Making the table again for each sub-environment would take most of a test; no step changes it.
    copies = [lambda: copy.deepcopy(first, {id(table): table})] * num_envs
    return SyncVectorEnv(copies, autoreset_mode=mode)


def assert_equal(one: Any, other: Any) -> None:
    """Asserts exact equality, types included, except for one bug of Gymnasium's that is not copied."""
    if len(one) == 5:  # a step
        mended = (*other[:4], mend(other[4], one[4]))
        assert data_equivalence(one, mended, exact=True), (one, other, MACHINE)
    else:
        assert data_equivalence(one, other, exact=True), (one, other, MACHINE)


def mend(infos: dict[str, Any], right: dict[str, Any]) -> dict[str, Any]:
    """Replaces probabilities that Gymnasium casts to integers after an autoreset of FrozenLake by the right ones."""
    infos = {**infos}
    if "prob" in infos:
        assert right["prob"].dtype == np.float64
        assert infos["prob"].tolist() == right["prob"].astype(infos["prob"].dtype).tolist()
        infos["prob"] = right["prob"]
    if "final_info" in infos:
        infos["final_info"] = mend(infos["final_info"], right["final_info"])
    return infos


def position(generator: np.random.Generator) -> Any:
    """The state of a generator, without the buffered half when it has been used."""
    state = dict(generator.bit_generator.state)
    return {**state, "uinteger": state["uinteger"] * state["has_uint32"]}


class LockstepVectorEnv:
    """Our vector environment beside Gymnasium's: what is done to one is done to both, and the results must be equal."""

    def __init__(
        self,
        name: str,
        num_envs: int,
        mode: AutoresetMode = AutoresetMode.NEXT_STEP,
        own: dict[str, Any] | None = None,
        **kwargs: Any,
    ) -> None:
        self.num_envs, self.mode = num_envs, mode
        self.ours = ours(name, num_envs, autoreset_mode=mode, **(own or {}), **kwargs)
        self.theirs = theirs(name, num_envs, mode, **kwargs)
        self.over = np.zeros(num_envs, np.bool_)

    def reset(self, **kwargs: Any) -> Any:
        mine, gymnasiums = copy.deepcopy(kwargs), copy.deepcopy(kwargs)
        one, other = self.ours.reset(**mine), self.theirs.reset(**gymnasiums)
        assert data_equivalence(mine, kwargs, exact=True), "the caller's options were changed"
        assert_equal(one, other)
        mask = (kwargs.get("options") or {}).get("reset_mask", np.True_)
        self.over &= ~mask
        return one

    def step(self, actions: Any) -> Any:
        one, other = self.ours.step(actions), self.theirs.step(actions)
        assert_equal(one, other)
        self.over = other[2] | other[3]
        return one

    def run(self, steps: int, seed: int = 0, dtype: Any = None) -> tuple[int, int]:
        """Takes random steps and returns how many episodes terminated and how many were truncated."""
        rng = np.random.default_rng(seed)
        terminated = truncated = 0
        for _ in range(steps):
            _, _, ended, cut, _ = self.step(self.actions(rng, dtype))
            terminated, truncated = terminated + int(ended.sum()), truncated + int(cut.sum())
            if self.mode is AutoresetMode.DISABLED and self.over.any():
                self.reset(options={"reset_mask": self.over.copy()})
        return terminated, truncated

    def actions(self, rng: np.random.Generator, dtype: Any = None) -> Any:
        space: Any = self.theirs.single_action_space
        if isinstance(space, gym.spaces.Discrete):
            return rng.integers(0, space.n, self.num_envs).astype(dtype or np.int64)
        # Some are beyond the bounds, where Gymnasium clips.
        return (space.high * rng.uniform(-1.5, 1.5, (self.num_envs, 1))).astype(dtype or np.float32)

    def same_streams(self) -> None:
        """Asserts that the generators have the same state and the same seeds."""
        for one, other in zip(self.ours.np_random, self.theirs.np_random, strict=True):
            assert position(one) == position(other)
        assert self.ours.np_random_seed == self.theirs.np_random_seed
