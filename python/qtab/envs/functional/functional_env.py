"""``qtab.FunctionalEnv``: a Gymnasium environment written as functions of its state."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import wraps
from inspect import signature
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import shown
from qtab.config.functions import checked_mask
from qtab.envs.functional.observations import observation_in
from qtab.envs.functional.structure import in_words, structure_of
from qtab.envs.in_rust.matching import NotInRustError

UNSET: Any = object()
"""Sentinel: there is no state before the first reset."""


class FunctionalEnv(gym.Env[Any, Any], ABC):
    """A Gymnasium environment written as functions of its state, after Gymnasium's ``FuncEnv``.

    A subclass has the attributes ``observation_space`` and ``action_space`` and the methods ``initial_state``,
    ``transition`` and ``observe``. Their random numbers come from the generator ``rng`` that they receive, and what
    changes in an episode is in the state: the methods do not change ``self``. This class adds the rest: ``reset`` and
    ``step``, seeds, checks, and :attr:`state`.

    The state is a number, a tuple of numbers and further tuples, or an array; a tuple can contain arrays. In Python, it
    can be any object.

    A subclass may also define:

    - ``action_mask(self, state)``: (actions,) booleans, the available actions. ``info["action_mask"]`` then contains
      the mask, as int8. In terminal states, it may be all zeros.
    - ``outcomes(self, state, action)``: every outcome of ``transition``, as a list of (probability, state, reward,
      terminated), and ``initial_outcomes(self)``: every first state, as a list of (probability, state). The
      probabilities sum to 1 within 1e-9. :func:`qtab.tabulate` needs them only for draws that it cannot list itself.
    - ``render(self, state)``: a picture of the state in the render mode ``self.render_mode``. ``env.render()`` calls it
      with the current state. In the mode "human", resets and steps call it. Gymnasium's ``render(self)`` works as well.

    ``reset(options={"state": state})`` begins an episode in a given state. There is no time limit; register an id with
    ``max_episode_steps``, or use ``gymnasium.wrappers.TimeLimit``.

    Args:
        render_mode: One of ``metadata["render_modes"]``; None does not render. A subclass with a constructor need not
            call this one.

    Raises:
        TypeError: if the subclass lacks one of the methods.
        ValueError: if ``render_mode`` is not in ``metadata["render_modes"]``.
    """

    _state: Any = UNSET
    _structure: Any = None
    """The structure of the first state."""

    def __init__(self, render_mode: str | None = None) -> None:
        modes = self.metadata.get("render_modes", [])
        if render_mode is not None and render_mode not in modes:
            raise ValueError(f"render_mode must be None or one of {modes}, got {render_mode!r}")
        self.render_mode = render_mode

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Lets ``render(self, state)`` be called without a state, as Gymnasium calls it."""
        super().__init_subclass__(**kwargs)
        own = vars(cls).get("render")
        if own is not None and len(signature(own).parameters) == 2:
            cls.render = _of_current_state(own)  # type: ignore[method-assign]

    def __repr__(self) -> str:
        """Returns the name of the class, and the id if there is one."""
        return str(self) if self.spec is not None else f"<{type(self).__name__}>"

    @abstractmethod
    def initial_state(self, rng: np.random.Generator) -> Any:
        """Returns the first state of an episode.

        Args:
            rng: The generator of the environment.
        """

    @abstractmethod
    def transition(self, state: Any, action: Any, rng: np.random.Generator) -> tuple[Any, float, bool]:
        """Returns the next state, the reward, and whether the next state is terminal. Does not change ``state``.

        Args:
            state: The state.
            action: The action: an int for a Discrete space.
            rng: The generator of the environment.
        """

    @abstractmethod
    def observe(self, state: Any) -> Any:
        """Returns the observation of a state.

        It is a number for a Discrete space; numbers in a tuple, a list or an array for a Box, a MultiDiscrete or a
        MultiBinary space; and a tuple of the observations of the parts for a Tuple or a Dict space, in the order of the
        space. They are converted to the dtype of the space.

        Args:
            state: The state.
        """

    def render(self) -> Any:
        """Refuses to render: a subclass may define ``render(self, state)``.

        Raises:
            NotImplementedError: always.
        """
        raise NotImplementedError(f"{type(self).__name__} has no method render(self, state)")

    @property
    def state(self) -> Any:
        """The current state. Setting it continues the episode from another state.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
            ValueError: when set to a state whose structure differs from that of the states before.
        """
        if self._state is UNSET:
            raise gym.error.ResetNeeded(f"{type(self).__name__} has no state before reset() is called")
        return self._state

    @state.setter
    def state(self, state: Any) -> None:
        self._check_structure(state, "state must be")
        self._state = state

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begins an episode, and returns the first observation and the info.

        Args:
            seed: The seed of a new generator; None keeps the generator.
            options: ``{"state": state}`` begins in this state; ``initial_state`` is not called. None draws the state.

        Raises:
            AttributeError: if the class has no spaces.
            TypeError: if an observation or a mask does not hold numbers.
            ValueError: if an observation, a mask or the state has another shape than it should.
        """
        super().reset(seed=seed)
        self._check_spaces()
        if options is not None and "state" in options:
            state, source = options["state"], "options['state'] must be"
        else:
            state = self.initial_state(self.np_random)
            source = f"initial_state of {type(self).__name__} must return"
        self._check_structure(state, source)
        observation, info = self._observation(state), self._info(state, terminated=False)
        self._state = state
        if self.render_mode == "human":
            self.render()
        return observation, info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Takes an action, and returns the observation, the reward, two flags (terminated, False) and the info.

        If this raises an error, the state is that before the step.

        Raises:
            gymnasium.error.InvalidAction: if the action is not in the action space.
            gymnasium.error.ResetNeeded: before the first reset.
            TypeError: if ``transition``, ``observe`` or ``action_mask`` returns values of other types than it should.
            ValueError: if the state, the observation or the mask has another shape than it should, the reward is not
                finite, the observation lies outside its space, or no action is available.
        """
        if not self.action_space.contains(action):
            raise gym.error.InvalidAction(f"action must be in {self.action_space}, got {shown(action)}")
        if isinstance(self.action_space, gym.spaces.Discrete):
            action = int(action)
        state, reward, terminated = self._checked(self.transition(self.state, action, self.np_random))
        observation, info = self._observation(state), self._info(state, terminated)
        self._state = state
        if self.render_mode == "human":
            self.render()
        return observation, reward, terminated, False, info

    def __qtab_env__(self) -> Any:
        """Returns the capsule ``qtab.env.1`` of the compiled functions, by which Rust steps the environment.

        Raises:
            NotInRustError: if Numba is not installed, or the functions cannot be compiled; it gives the reason.
        """
        from qtab.compilation import NotCompilable
        from qtab.compilation.functional import capsule_of

        self._check_spaces()
        try:
            return capsule_of(self)
        except NotCompilable as refusal:
            raise NotInRustError(refusal.place_and_reason, refusal.advice, refusal.problems) from None

    def __qtab_env_failed__(self, state: bytes | None, action: int | None, rng: np.random.Generator) -> None:
        """Repeats a call in Python that failed in compiled code, so that it raises the error.

        Args:
            state: The bytes of the state before the step; None for a reset.
            action: The action, counted from 0; None for a reset.
            rng: A generator in the state before the call.

        Raises:
            RuntimeError: if the call does not fail in Python.
        """
        if state is None or action is None:
            first = self.initial_state(rng)
            self._observation(first)
            self._info(first, terminated=False)
        else:
            (before,) = self._states_in([state])
            first_action = int(self.action_space.start)  # type: ignore[attr-defined]
            following, _, terminated = self._checked(self.transition(before, first_action + action, rng))
            self._observation(following)
            self._info(following, terminated)
        raise RuntimeError(f"{type(self).__name__} failed in compiled code, but not in Python")

    def _states_in(self, memories: Sequence[bytes]) -> list[Any]:
        """Returns the states whose bytes compiled code has written."""
        from qtab.compilation.functional import compiled_env, state_from

        compiled, _ = compiled_env(self)
        return [state_from(self, compiled, memory) for memory in memories]

    def _checked(self, returned: Any) -> tuple[Any, float, bool]:
        name = f"transition of {type(self).__name__}"
        if not isinstance(returned, tuple) or len(returned) != 3:
            got = f"{len(returned)} values: " if isinstance(returned, tuple) else ""
            raise TypeError(f"{name} must return (state, reward, terminated), got {got}{shown(returned)}")
        state, reward, terminated = returned
        self._check_structure(state, f"{name} must return")
        try:
            number = float(reward)
        except (TypeError, ValueError):
            raise TypeError(f"{name} must return a number as the reward, got {shown(reward)}") from None
        if not math.isfinite(number):
            raise ValueError(f"{name} must return a finite number as the reward, got {shown(reward)}")
        if not isinstance(terminated, bool | np.bool_):
            raise TypeError(f"{name} must return a boolean as terminated, got {shown(terminated)}")
        return state, number, bool(terminated)

    def _observation(self, state: Any) -> Any:
        return observation_in(self.observation_space, self.observe(state), f"observe of {type(self).__name__}")

    def _info(self, state: Any, terminated: bool) -> dict[str, Any]:
        function: Callable[[Any], Any] | None = getattr(self, "action_mask", None)
        if function is None:
            return {}
        return {"action_mask": self._mask(function(state), terminated)}

    def _mask(self, given: Any, terminated: bool) -> NDArray[np.int8]:
        if not isinstance(self.action_space, gym.spaces.Discrete):
            raise TypeError(f"action_mask needs a Discrete action space, got {self.action_space}")
        count = int(self.action_space.n)
        if terminated and np.shape(given) == (count,) and not np.any(given):
            return np.zeros(count, np.int8)
        return checked_mask(f"action_mask of {type(self).__name__}", given, count).astype(np.int8)

    def _check_spaces(self) -> None:
        for name in ("observation_space", "action_space"):
            if not isinstance(getattr(self, name, None), gym.Space):
                raise AttributeError(f"{type(self).__name__} must have an attribute {name}, a space of Gymnasium")

    def _check_structure(self, state: Any, source: str) -> None:
        found = structure_of(state)
        if self._structure is None:
            self._structure = found
        elif found != self._structure:
            raise ValueError(f"{source} {in_words(self._structure)}, as before, got {in_words(found)}")


def _of_current_state(function: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(function)
    def render(self: FunctionalEnv, state: Any = UNSET) -> Any:
        return function(self, self.state if state is UNSET else state)

    return render
