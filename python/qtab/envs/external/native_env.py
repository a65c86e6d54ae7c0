"""``qtab.NativeEnv``: an environment in a shared library, written in C, Rust or another compiled language."""

import operator
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded

from qtab import _core
from qtab.envs.external.library import load, load_again
from qtab.envs.origin.class_code import LIBRARY, class_code


class NativeEnv(gym.Env[Any, Any]):
    """An environment in a shared library with the interface ``qtab_env.h``; see :func:`qtab.get_include`.

    Rust steps it in training, without Python. It is also a complete Gymnasium environment: ``reset`` and ``step`` draw
    from ``np_random``, which may be any generator of NumPy, and give the same numbers as training.

    Observations of one int64 are those of a Discrete space, of several those of a MultiDiscrete space; those of float32
    or float64 are a Box. If the environment has action masks, they are in ``info["action_mask"]``, an int8 array with
    an item for each action, and training uses them with ``action_mask=True``.

    When a library is loaded, its sizes are checked, and some random steps are taken, first in a separate process. After
    each of them the numbers are checked, and the memory beyond them. A library that crashes later ends the process, as
    any native code does. The file may be compiled again while it is in use: a ``NativeEnv`` made afterwards has the new
    functions.

    Args:
        path: The path of the shared library, such as ``"./libmy_env.so"``.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it is not a library for this machine, exports no function ``qtab_env_1``, was made for another
            version of the interface, crashes, or breaks a rule, such as an observation that is not a number.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012 - Gymnasium's attribute

    def __init__(self, path: "str | os.PathLike[str]") -> None:
        self.library = os.fspath(path)
        """The path of the library."""
        self.render_mode = None
        self._library = load(path)
        external = self._library.external
        self.observation_space = space_of(external)
        self.action_space = spaces.Discrete(external.num_actions)
        self.max_episode_steps: int | None = external.max_episode_steps
        """The time limit in steps; None if there is none."""
        self._episode: _core.ExternalEpisode | None = None
        self._elapsed = 0

    def __repr__(self) -> str:
        """Returns one line with the path."""
        return f"<{type(self).__name__} of {self.library!r}>"

    def __qtab_env__(self) -> Any:
        """Returns the capsule by which Rust steps the environment."""
        return self._library.capsule

    @property
    def code_digest(self) -> str:
        """A digest of the content of the library, and of a subclass."""
        code = class_code(type(self))
        return f"library:{self._library.digest}" + ("" if code is None or code == LIBRARY else f" {code}")

    @property
    def state(self) -> bytes:
        """The state of the episode: ``state_size`` bytes, whose meaning is the library's.

        It can be set to bytes that it had before. The library is not protected from other bytes.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
            ValueError: if it is set to another number of bytes.
        """
        return self._started("read the state").state()

    @state.setter
    def state(self, state: bytes) -> None:
        self._started("set the state").set_state(state)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begins an episode.

        Args:
            seed: A seed for ``np_random``; None leaves it as it is.
            options: Ignored.

        Returns:
            The first observation, and the info with the action mask if there is one.

        Raises:
            RuntimeError: if the function of the library fails.
            ValueError: if it returns an unknown code.
        """
        super().reset(seed=seed, options=options)
        episode = self._episode or _core.ExternalEpisode(self._library.external)
        bit_generator = self.np_random.bit_generator
        with bit_generator.lock:
            episode.reset(bit_generator)
        self._episode, self._elapsed = episode, 0
        return self._observation(episode), self._info(episode)

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Takes one step; the episode is truncated after ``max_episode_steps`` steps.

        Args:
            action: An integer from 0 to ``action_space.n - 1``.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
            IndexError: if there is no such action.
            TypeError: if the action is not an integer.
            RuntimeError: if the function of the library fails.
            ValueError: if its reward is not a finite number.
        """
        episode, action = self._started("step"), operator.index(action)
        count = self._library.external.num_actions
        if not 0 <= action < count:
            raise IndexError(f"action must be from 0 to {count - 1}, got {action}")
        bit_generator = self.np_random.bit_generator
        with bit_generator.lock:
            reward, terminated, truncated = episode.step(action, bit_generator)
        self._elapsed += 1
        if self.max_episode_steps is not None and self._elapsed >= self.max_episode_steps and not terminated:
            truncated = True
        return self._observation(episode), reward, terminated, truncated, self._info(episode)

    def __getstate__(self) -> dict[str, Any]:
        """Returns the attributes, with the library's path and digest, and the bytes of the state."""
        state = None if self._episode is None else self._episode.state()
        return {**vars(self), "_library": (str(Path(self.library).resolve()), self._library.digest), "_episode": state}

    def __setstate__(self, attributes: Mapping[str, Any]) -> None:
        """Loads the library again, and continues the episode.

        Raises:
            FileNotFoundError: if the file is gone, and this process has not loaded it.
            ValueError: if it was compiled again since.
        """
        vars(self).update(attributes)
        self._library = load_again(*attributes["_library"])
        state, self._episode = attributes["_episode"], None
        if state is not None:
            self._episode = _core.ExternalEpisode(self._library.external)
            self._episode.set_state(state)

    def _started(self, what: str) -> _core.ExternalEpisode:
        if self._episode is None:
            raise ResetNeeded(f"Cannot {what} before calling env.reset()")
        return self._episode

    def _observation(self, episode: _core.ExternalEpisode) -> Any:
        observation = episode.observation()
        return int(observation[0]) if isinstance(self.observation_space, spaces.Discrete) else observation

    def _info(self, episode: _core.ExternalEpisode) -> dict[str, Any]:
        return {"action_mask": episode.action_mask()} if self._library.external.has_action_mask else {}


def space_of(external: _core.ExternalEnv) -> "spaces.Space[Any]":
    """Returns the observation space of the environment in a library."""
    low, high = (np.array(bounds, np.float64) for bounds in zip(*external.bounds, strict=True))
    if external.dtype != "int64":
        dtype = np.dtype(external.dtype)
        return spaces.Box(low.astype(dtype), high.astype(dtype), dtype=dtype.type)
    first = low.astype(np.int64)
    counts = high.astype(np.int64) - first + 1
    if len(counts) == 1:
        return spaces.Discrete(int(counts[0]), start=int(first[0]))
    return spaces.MultiDiscrete(counts, start=first)
