"""``gymnasium.make_vec("qtab/…")``: all sub-environments in one call of Rust a step."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.toy_text.taxi import TaxiEnv
from gymnasium.error import Error, ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from qtab import _core
from qtab._utils import checks
from qtab.envs.native import toy_text_spec
from qtab.envs.python_vector import SubEnvironments, paint
from qtab.envs.registry import PREFIX

_FAR = 1e6
"""First states so far out may overflow, which is left to Gymnasium's code."""


class RustVectorEnv(_core.Vector, VectorEnv[Any, Any, Any]):
    """Any number of sub-environments of one kind, stepped together in Rust, with the numbers of Gymnasium's own.

    It is what ``SyncVectorEnv([lambda: gymnasium.make(id)] * num_envs)`` is, bit for bit: arrays, dtypes, infos, seeds,
    time limits. Two things differ: the ``prob`` of toy text stays a float after an autoreset, and what is refused
    changes nothing. ``np_random`` hands out the generators that are drawn from.

    Whoever asks for the sub-environments themselves (``envs``, ``call``, ``get_attr``, ``set_attr``) gets them, as
    they stand, and from then on they are stepped in Python, one by one. So they are from the beginning with a window
    (``render_mode="human"``), a list of frames, Taxi's frames, a constant that Rust does not compute with, and, for
    CartPole, Acrobot and Pendulum, on a machine on which NumPy's sine and cosine are not the platform's.

    Args:
        name: Gymnasium's id of the environment.
        num_envs: How many there are.
        max_episode_steps: A limit other than the spec's, as ``gymnasium.make`` takes it (-1: none).
        copy: Whether observations are handed out in new arrays; if not, in the same arrays each time.
        autoreset_mode: What becomes of a sub-environment whose episode is over: an ``AutoresetMode``, or its value.
        threads: How many threads step them; None means as many as pay. The results are the same for any number.
        kwargs: Everything else that ``gymnasium.make`` takes.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
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
        self.num_envs = checks.integer("num_envs", num_envs, least=1)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.copy = bool(copy)
        # A spec, since an id of an old version would be warned of a second time.
        spec = gym.spec(PREFIX + name)
        self._make = partial(gym.make, spec, max_episode_steps=max_episode_steps, **kwargs)
        self._example = self._make()
        self.metadata = {**self._example.metadata, "autoreset_mode": self.autoreset_mode}
        self.render_mode = self._example.render_mode
        self.single_observation_space = self._example.observation_space
        self.single_action_space = self._example.action_space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._stage: list[gym.Env[Any, Any]] = []
        self._python: SubEnvironments | None = None
        threads = None if threads is None else checks.threads(threads)
        if not self._launched(threads):
            self._leave_rust()

    def _launched(self, threads: int | None) -> bool:
        """Makes the sub-environments in Rust, if it stands for them."""
        env = self._example.unwrapped
        # A taxi's picture depends on the pictures before it.
        painted = self.render_mode in ("rgb_array", "ansi") and not isinstance(env, TaxiEnv)
        if self.render_mode is not None and not painted:
            return False
        try:
            kind = None if isinstance(env, _core.Physics) else toy_text_spec(env)
        except (TypeError, ValueError):  # a table that Gymnasium may take, but Rust does not
            return False
        limited = self._example.has_wrapper_attr("_max_episode_steps")
        limit = self._example.get_wrapper_attr("_max_episode_steps") if limited else None
        return self.launch(
            env,
            kind,
            [env.action_mask(state).tolist() for state in range(500)] if isinstance(env, TaxiEnv) else None,
            self.num_envs,
            # Gymnasium takes any integer, and nobody lives to see the largest of 64 bits.
            None if limit is None else min(limit, checks.LARGEST_COUNT),
            self.autoreset_mode.value,
            self.copy,
            threads,
        )

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begins an episode in each sub-environment, or in those of ``options["reset_mask"]``.

        Args:
            seed: None, an integer that the first sub-environment is seeded with, the next with the next; or a list.
            options: The sub-environments' own options, and ``reset_mask``: (num_envs,) bool.

        Returns:
            All observations, and infos of those that were reset.

        Raises:
            gymnasium.error.Error: for a seed that is not a non-negative integer.
            gymnasium.error.ResetNeeded: for a mask that leaves out what was never reset.
            TypeError: for a mask that is no array of bool.
            ValueError: for a mask or a list of another length, a mask without any; Gymnasium's for its options.
        """
        seeds = self._seeds(seed)
        options = None if options is None else dict(options)
        mask = None if options is None or "reset_mask" not in options else self._mask(options.pop("reset_mask"))
        start = self._start(options) if self.launched else None
        if self._python is not None:
            masked = options if mask is None else {**(options or {}), "reset_mask": mask}
            return self._python.reset(seed=seeds, options=masked)
        lanes = range(self.num_envs) if mask is None else np.flatnonzero(mask).tolist()
        return self.begin(list(lanes), [seeds[lane] for lane in lanes], start)

    def _seeds(self, seed: Any) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int):
            seeds: list[Any] = [seed + lane for lane in range(self.num_envs)]
        elif isinstance(seed, list | tuple):
            seeds = list(seed)
        else:
            raise TypeError(f"seed must be an integer, a list of integers or None, got {seed!r}")
        if len(seeds) != self.num_envs:
            raise ValueError(
                f"If seeds are passed as a list the length must match num_envs={self.num_envs} but got "
                f"length={len(seeds)}."
            )
        for lane, one in enumerate(seeds):
            if one is not None and not isinstance(one, int):
                raise Error(f"sub-environment {lane}: Seed must be a python integer, actual type: {type(one)}")
            if one is not None and one < 0:
                raise Error(f"sub-environment {lane}: Seed must be greater or equal to zero, actual value: {one}")
        return seeds

    def _mask(self, mask: Any) -> NDArray[np.bool_]:
        place = "`options['reset_mask']` must"
        if not isinstance(mask, np.ndarray):
            raise TypeError(f"{place} be a numpy array, got {type(mask)}")
        if mask.shape != (self.num_envs,):
            raise ValueError(f"{place} have shape `({self.num_envs},)`, got {mask.shape}")
        if mask.dtype != np.bool_:
            raise TypeError(f"{place} have `dtype=np.bool_`, got {mask.dtype}")
        if not mask.any():
            raise ValueError(f"{place} contain a boolean array with at least one True value, got reset_mask={mask}")
        unbegun = self.unbegun() if self._python is None else self._python.unbegun()
        missing = [lane for lane in unbegun if not mask[lane]]
        if missing:
            raise ResetNeeded(f"{place} not leave out sub-environment {missing[0]}, which was never reset")
        return mask

    def _start(self, options: dict[str, Any] | None) -> tuple[float, float] | None:
        """Returns the numbers that bound first states, if the options say others than the usual ones."""
        names = self.start()
        if names is None or not options:
            return None
        self._example.reset(options=options)  # Gymnasium's errors, before anything changes
        low, high = (float(options.get(name, default)) for name, default in names)
        if max(abs(low), abs(high)) > _FAR:
            self._leave_rust()
        return low, high

    @property  # type: ignore[misc]
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """The generators that the sub-environments draw from."""
        if self._python is not None:
            return self._python.np_random
        return tuple(self._generator(lane) for lane in range(self.num_envs))

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """What each was seeded with."""
        if self._python is not None:
            return self._python.np_random_seed
        return tuple(self.seed_of(lane) for lane in range(self.num_envs))

    def _generator(self, lane: int) -> np.random.Generator:
        """Returns a sub-environment's generator, which it draws from itself from now on."""
        source = self.source(lane)
        if isinstance(source, tuple):
            drawn, half = source
            bits = np.random.PCG64(np.random.SeedSequence(self.seed_of(lane)))
            bits.advance(drawn)
            bits.state = {**bits.state, "has_uint32": int(half is not None), "uinteger": half or 0}
            source = np.random.Generator(bits)
            self.draw_from(lane, source)
        return source

    def render(self) -> tuple[Any, ...]:
        """Returns what each sub-environment's ``render`` returns."""
        if self.render_mode is None:
            self._leave_rust()
        if self._python is not None:
            return self._python.render()
        missing = self.unbegun()
        if missing:
            raise ResetNeeded(f"Cannot call `env.render()` before calling `env.reset()`: sub-environment {missing[0]}")
        if not self._stage:
            self._stage = [self._make() for _ in range(self.num_envs)]
            for env in self._stage:
                env.reset(seed=0)
        for env, portrait in zip(self._stage, self.portraits(), strict=True):
            paint(env, portrait)
        return tuple(env.render() for env in self._stage)

    @property
    def envs(self) -> list[gym.Env[Any, Any]]:
        """The sub-environments, which are stepped in Python from now on."""
        return self._sub_environments().envs

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Calls a method of each sub-environment, or returns an attribute of each."""
        return self._sub_environments().call(name, *args, **kwargs)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Returns an attribute of each sub-environment."""
        if name in ("np_random", "np_random_seed"):
            attributes: tuple[Any, ...] = getattr(self, name)
            return attributes
        return self.call(name)

    def set_attr(self, name: str, values: list[Any] | tuple[Any, ...] | Any) -> None:
        """Sets an attribute of each sub-environment, to a value for each or to one for all."""
        self._sub_environments().set_attr(name, values)

    def step_in_python(self, actions: Any) -> Any:
        """One step of what Rust does not stand for."""
        return self._sub_environments().step(actions)

    def _sub_environments(self) -> SubEnvironments:
        self._leave_rust()
        assert self._python is not None  # noqa: S101 - it was just made
        return self._python

    def _leave_rust(self) -> None:
        """Goes on in Python, where Rust stands."""
        if self._python is not None:
            return
        python = SubEnvironments([self._make] * self.num_envs, copy=self.copy, autoreset_mode=self.autoreset_mode)
        if self.launched:
            python.go_on(self.portraits(), self.unbegun(), self.np_random, self.np_random_seed)
            self.retire()
        self._python = python

    def close_extras(self, **kwargs: Any) -> None:
        """Closes every environment that was made."""
        self._example.close()
        for env in self._stage:
            env.close()
        if self._python is not None:
            self._python.close(**kwargs)

    def __reduce__(self) -> Any:
        raise TypeError("a vector environment in Rust can neither be copied nor pickled: make another")


def __getattr__(name: str) -> Any:
    """Gives each id its entry point: ``qtab.envs.vector:CartPole-v1``."""
    if gym.registry.get(PREFIX + name) is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return partial(RustVectorEnv, name)
