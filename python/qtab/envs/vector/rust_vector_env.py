"""``gymnasium.make_vec("qtab/…")``: a vector environment that steps all sub-environments in one call of Rust."""

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from qtab import _core
from qtab._utils import checks
from qtab.envs.vector.arguments import (
    MAX_RESET_BOUND,
    check_reset_mask,
    entry_to_step,
    known_env,
    limit_of_wrappers,
    reset_bounds,
    seeds_of,
    spec_to_step,
)
from qtab.envs.vector.own_env import OwnEnv
from qtab.envs.vector.python_vector_env import PythonVectorEnv, Snapshot, draws_its_state, generators, restore


class RustVectorEnv(_core.VectorEnv, VectorEnv[Any, Any, Any]):
    """A vector environment of equal sub-environments, stepped together in Rust.

    It equals ``SyncVectorEnv([lambda: gymnasium.make(id)] * num_envs)`` bit for bit: arrays, dtypes, infos, seeds and
    time limits. There are two differences: the info ``prob`` of toy text stays a float after an autoreset, and a call
    that raises an error changes nothing. ``np_random`` returns the generators that the sub-environments draw from.

    Accessing the sub-environments (``envs``, ``call``, ``get_attr``, ``set_attr``) switches the vector environment to
    Python stepping, one sub-environment after another, with their current states. It steps in Python from the start

    - with a window (``render_mode="human"``), with lists of frames, and with frames of Taxi;
    - with a constructor argument that Rust does not compute with;
    - for CartPole, Acrobot and Pendulum on machines where NumPy does not take sine and cosine from the C library;
    - for a class of your own with a render mode;
    - for a :class:`qtab.FunctionalEnv` that cannot be compiled. The logger ``qtab`` reports the reason.

    An environment of your own also switches to Python stepping when ``np_random`` is accessed, and at a reset with
    options that it reads: ``state`` for a ``FunctionalEnv``, any for an ordinary class. An ordinary class does so as
    well at a step that fails in compiled code only. The logger ``qtab`` reports both. The ``final_obs`` of an ordinary
    class with a Discrete space are Python integers. An exception of a step or a reset is raised as it is in Python.

    Args:
        name: The id of an environment that Rust steps: Gymnasium's, one with the prefix ``qtab/``, or one that you
            registered for a :class:`qtab.TabularEnv`, a :class:`qtab.FunctionalEnv`, a :class:`qtab.NativeEnv` or a
            class that Numba compiles, whose info dicts are empty or hold only ``action_mask``.
        num_envs: The number of sub-environments.
        max_episode_steps: A time limit other than the spec's, as in ``gymnasium.make`` (-1: no limit).
        copy: Whether each step returns new arrays of observations. If False, it returns the same arrays each time.
        autoreset_mode: The reset of sub-environments whose episode has ended: an ``AutoresetMode`` or its value.
        threads: The largest number of threads; None means one per core. Threads start at each step, so that fewer are
            used unless each has at least some hundreds to thousands of sub-environments. The number does not change
            the results.
        kwargs: Further arguments of ``gymnasium.make``.

    It deep-copies and pickles: the copy continues the episodes with the same numbers.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an environment that Rust does not implement and Numba cannot
            compile.
    """

    def __init__(
        self,
        name: str,
        num_envs: int = 1,
        max_episode_steps: int | None = None,
        copy: bool = True,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        **kwargs: Any,
    ) -> None:
        spec = spec_to_step(name)
        self.num_envs = checks.integer("num_envs", num_envs, least=1)
        self._autoreset_mode = AutoresetMode(autoreset_mode)
        self.copy = checks.boolean("copy", copy)
        self._make = partial(gym.make, spec, max_episode_steps=max_episode_steps, **kwargs)
        self.example = self._make()
        """An environment like the sub-environments, which is never stepped."""
        entry = entry_to_step(spec, self.example)
        self._own = None if entry is not None else OwnEnv(self._make, self.example, self._autoreset_mode)
        self._entry_name = spec.id if entry is None else entry.name
        self.metadata = {**self.example.metadata, "autoreset_mode": self.autoreset_mode}
        self.render_mode = self.example.render_mode
        self.single_observation_space = self.example.observation_space
        self.single_action_space = self.example.action_space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._render_envs: list[gym.Env[Any, Any]] = []
        self._python: PythonVectorEnv | None = None
        self._threads = None if threads is None else checks.threads(threads)
        if not self._start_in_rust():
            self._fall_back_to_python()

    _own: OwnEnv | None = None  # also in pickles of earlier versions

    def _start_in_rust(self) -> bool:
        """Creates the sub-environments in Rust; returns False if Rust does not support them."""
        env = self.example.unwrapped
        # A frame of Taxi depends on the frames before it, and one of a user's class may.
        can_render = self.render_mode in ("rgb_array", "ansi") and draws_its_state(env)
        if self.render_mode is not None and not can_render:
            return False
        own = self._own
        native = known_env(self._entry_name, env) if own is None else own.in_rust(self.num_envs, self.copy)
        if native is None:
            return False
        limit = limit_of_wrappers(self.example)
        return self.start(native, self.num_envs, limit, self.autoreset_mode.value, self.copy, self._threads)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Starts an episode in every sub-environment, or in those selected by ``options["reset_mask"]``.

        Args:
            seed: None; an integer, to seed the sub-environments with ``seed``, ``seed + 1``, …; or a list of num_envs.
            options: The sub-environments' reset options, and ``reset_mask``: (num_envs,) bool.

        Returns:
            The observations of all sub-environments, and the infos of those that were reset.

        Raises:
            gymnasium.error.Error: for a seed that is not a non-negative integer.
            gymnasium.error.ResetNeeded: for a mask that leaves out a sub-environment that was never reset.
            TypeError: for a mask that is not a NumPy array of bool, or a seed of another type.
            ValueError: for a mask of another shape or without any True, or a list of seeds of another length;
                Gymnasium's errors for its options.
        """
        seeds = seeds_of(seed, self.num_envs)
        options = None if options is None else dict(options)
        mask = None
        if options is not None and "reset_mask" in options:
            mask = check_reset_mask(options.pop("reset_mask"), self.num_envs, self.not_reset())
        if self._own is not None and self.is_native and self._own.needs_python(options):
            self._own.log_options()
            self._fall_back_to_python()
        bounds = reset_bounds(self.reset_bounds(), self.example, options) if self.is_native else None
        if bounds is not None and max(map(abs, bounds)) > MAX_RESET_BOUND:
            self._fall_back_to_python()
        if self._python is None:
            indices = range(self.num_envs) if mask is None else np.flatnonzero(mask).tolist()
            with suppress(_core.CompiledCodeError):
                return self.native_reset(list(indices), [seeds[index] for index in indices], bounds)
        masked = options if mask is None else {**(options or {}), "reset_mask": mask}
        return self._fall_back_to_python().reset(seed=seeds, options=masked)

    def not_reset(self) -> list[int]:
        """Returns the indices of the sub-environments that were never reset."""
        return super().not_reset() if self._python is None else self._python.not_reset()

    @property
    def autoreset_mode(self) -> AutoresetMode:
        """The reset of sub-environments whose episode has ended, chosen when the vector environment is made."""
        return self._autoreset_mode

    @autoreset_mode.setter
    def autoreset_mode(self, mode: AutoresetMode | str) -> None:
        raise AttributeError(
            "autoreset_mode cannot be assigned: it is chosen when the vector environment is made, with "
            f"gymnasium.make_vec(..., autoreset_mode={getattr(mode, 'value', mode)!r})"
        )

    @property  # type: ignore[misc]
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """The random generators of the sub-environments. Python steps an environment of one's own from then on."""
        if self._own is not None or self._python is not None:
            return self._fall_back_to_python().np_random
        return generators(self, self.num_envs)

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """The seeds of the sub-environments' generators."""
        if self._python is not None:
            return self._python.np_random_seed
        return tuple(self.seed_of(index) for index in range(self.num_envs))

    def snapshots(self) -> list[Snapshot]:
        """Returns the state of each sub-environment that Rust steps, as Python can continue from it."""
        snapshots = super().snapshots()
        if self._own is None:
            return snapshots
        if self._own.is_ordinary:
            played = self._in_python().envs if self.is_native else []
            return [(vars(env.unwrapped), *rest) for env, (_, *rest) in zip(played, snapshots, strict=True)]
        return self._own.in_python(snapshots, self.not_reset())

    def render(self) -> tuple[Any, ...]:
        """Returns the result of each sub-environment's ``render``.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
        """
        if self.render_mode is None:
            self._fall_back_to_python()
        if self._python is not None:
            return self._python.render()
        missing = self.not_reset()
        if missing:
            raise ResetNeeded(f"Cannot call `env.render()` before calling `env.reset()`: sub-environment {missing[0]}")
        if not self._render_envs:
            self._render_envs = [self._make() for _ in range(self.num_envs)]
            for env in self._render_envs:
                env.reset(seed=0)
        for env, snapshot in zip(self._render_envs, self.snapshots(), strict=True):
            restore(env, snapshot)
        return tuple(env.render() for env in self._render_envs)

    @property
    def envs(self) -> list[gym.Env[Any, Any]]:
        """The sub-environments, which Python steps from now on."""
        return self._fall_back_to_python().envs

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Calls a method of each sub-environment, or returns an attribute of each."""
        return self._fall_back_to_python().call(name, *args, **kwargs)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Returns an attribute of each sub-environment."""
        if name in ("np_random", "np_random_seed"):
            attributes: tuple[Any, ...] = getattr(self, name)
            return attributes
        return self.call(name)

    def set_attr(self, name: str, values: list[Any] | tuple[Any, ...] | Any) -> None:
        """Sets an attribute of each sub-environment, to a list of values or to the same value for all."""
        self._fall_back_to_python().set_attr(name, values)

    def step_in_python(self, actions: Any) -> Any:
        """Takes one step of sub-environments that Rust does not support."""
        return self._fall_back_to_python().step(actions)

    def _fall_back_to_python(self) -> PythonVectorEnv:
        """Returns the sub-environments in Python, which continue from the current states the first time."""
        if self._python is not None:
            return self._python
        python = self._in_python()
        self.release()
        self._python = python
        return python

    def _in_python(self) -> PythonVectorEnv:
        """Returns other sub-environments, in Python, with the episodes of those in Rust if there are any."""
        python = PythonVectorEnv([self._make] * self.num_envs, copy=self.copy, autoreset_mode=self.autoreset_mode)
        if self.is_native and self._own is not None and self._own.is_ordinary:
            positions: list[Any] = [self.rng(index) for index in range(self.num_envs)]
            python.play_again(super().snapshots(), self.not_reset(), positions, self.np_random_seed)
        elif self.is_native:
            python.resume_from(self.snapshots(), self.not_reset(), generators(self, self.num_envs), self.np_random_seed)
        return python

    def close_extras(self, **kwargs: Any) -> None:
        """Closes every environment that was created."""
        self.example.close()
        for env in self._render_envs:
            env.close()
        if self._python is not None:
            self._python.close(**kwargs)

    def __getstate__(self) -> dict[str, Any]:
        """Returns the Python attributes, and the episodes and generators that Rust holds."""
        # The environments that draw frames hold surfaces, which cannot be copied, and nothing else worth keeping.
        attributes = {**self.__dict__, "_render_envs": []}
        if not self.is_native:
            return {"attributes": attributes}
        sources = [self.rng(index) for index in range(self.num_envs)]
        return {
            "attributes": attributes,
            "checkpoint": self.checkpoint(),
            "seeds": [self.seed_of(index) for index in range(self.num_envs)],
            "generators": {index: source for index, source in enumerate(sources) if not isinstance(source, tuple)},
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state["attributes"])
        if self.__dict__.pop("_is_own", False):  # of an earlier version
            self._own = OwnEnv(self._make, self.example, self._autoreset_mode)
        if "checkpoint" not in state:
            return
        code = None if self._own is None else self._own.code
        if not self._start_in_rust() or (self._own is not None and self._own.code != code):
            raise ValueError(f"Rust cannot continue the episodes of {self._entry_name} on this machine")
        self.restore(state["checkpoint"], state["seeds"])
        for index, generator in state["generators"].items():
            self.set_rng(index, generator)
