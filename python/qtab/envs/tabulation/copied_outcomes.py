"""The outcomes of any Gymnasium environment that can be copied: each copy is stepped once."""

import copy
from collections.abc import Hashable, Sequence
from fractions import Fraction
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.config.functions import checked_mask
from qtab.envs.tabulation.branches import Branches, CannotListError
from qtab.envs.tabulation.generator import ListingGenerator
from qtab.envs.tabulation.later_resets import Reset, difference
from qtab.envs.tabulation.listed_steps import finite_reward, listed
from qtab.envs.tabulation.state_keys import NotComparableError, attributes_key, part_outside_attributes, state_text
from qtab.envs.tabulation.walk import Outcome, Visit

_NOT_STATE = ("_np_random", "_np_random_seed", "spec", "metadata", "render_mode", "observation_space", "action_space")
"""Attributes of an environment that no step changes, and the generator."""


class _Place:
    """A state and an action as messages name them; the text is made only for a message.

    Args:
        outcomes: The outcomes of the environment.
        state: The state.
        action: The action.
    """

    def __init__(self, outcomes: "CopiedOutcomes", state: Any, action: int) -> None:
        self._outcomes, self._state, self._action = outcomes, state, action

    def __str__(self) -> str:
        return f"in the state {state_text(self._outcomes.attributes(self._state))} for action {self._action}"


class CopiedOutcomes:
    """The outcomes of an environment whose state is in its attributes.

    A state is a copy of the environment. Two states are equal if all attributes are.

    Args:
        env: The environment. It is copied, and not stepped.

    Raises:
        ValueError: if it cannot be copied, or has a state outside its attributes.
    """

    name_of_state = "self"

    def __init__(self, env: gym.Env[Any, Any]) -> None:
        self._branches = Branches()
        self._rng = ListingGenerator(self._branches)
        self._name = type(env).__name__
        if (reason := part_outside_attributes(type(env))) is not None:
            raise ValueError(f"env must keep its state in attributes, but it is a {self._name}, {reason}")
        self._first: Reset | None = None
        self._ended: set[Hashable] = set()
        """The keys of the terminal states after which a reset was compared with the first one."""
        self._shared = [env.observation_space, env.action_space, env.metadata, env.spec]
        """Objects that the copies share."""
        try:
            self._env = self._copy(env)
        except Exception as error:  # copying runs code of any class
            raise ValueError(f"env must be one that copy.deepcopy copies, but {self._name} raises {error!r}") from error

    def initial(self) -> list[tuple[Fraction, Visit]]:
        """Returns the first states of an episode with their probabilities.

        Raises:
            ValueError: if the first states cannot be listed or compared.
        """
        self._first = self._resets(self._env)
        return list(self._first.visits)

    def step(self, state: Any, action: int) -> list[Outcome]:
        """Returns the outcomes of an action.

        Raises:
            TypeError: if the reward is not a number.
            ValueError: if the outcomes cannot be listed, depend on more than the attributes, or truncate the episode,
                or if an episode after a terminal state begins differently than the first one.
        """
        where = _Place(self, state, action)

        def take() -> Outcome:
            return self._step(state, action, where)

        try:
            found, repeated = listed(self._branches, take)
        except CannotListError as error:
            raise self._refused("step", error, f", {where}") from None
        if not repeated:
            raise ValueError(
                f"step of {self._name} must depend only on its attributes: a repeated step of a copy with the same "
                f"random numbers returned another result, {where}"
            )
        for one in found:
            if one.terminated:
                self._check_next_episode(one.visit)
        return found

    def plain_states(self, states: Sequence[Any]) -> list[Any]:
        """Returns the attributes of the states that differ between them, as dicts."""
        every = [self.attributes(state) for state in states]
        keys: dict[str, set[Hashable]] = {}
        for state, attributes in zip(states, every, strict=True):
            for name, value in attributes.items():
                keys.setdefault(name, set()).add(attributes_key(state, {name: value}))
        differing = {name for name, found in keys.items() if len(found) > 1 or any(name not in one for one in every)}
        return [{name: value for name, value in one.items() if name in differing} for one in every]

    def check_unchanged(self) -> None:
        """Does nothing: only copies are stepped."""

    def attributes(self, env: Any) -> dict[str, Any]:
        """Returns the attributes of a copy that make its state."""
        return {name: value for name, value in vars(env).items() if name not in _NOT_STATE}

    def _copy(self, env: Any) -> Any:
        generator, env._np_random = env._np_random, None
        try:
            return copy.deepcopy(env, {id(one): one for one in self._shared})
        finally:
            env._np_random = generator

    def _resets(self, before: Any) -> Reset:
        try:
            visits = list(self._branches.outcomes(lambda: self._reset(before)))
        except CannotListError as error:
            raise self._refused("reset", error, "") from None
        return Reset(before, visits, self.attributes)

    def _check_next_episode(self, last: Visit) -> None:
        if self._first is None or last.key in self._ended:
            return
        self._ended.add(last.key)
        found = difference(self._first, self._resets(last.state))
        if found is not None:
            raise ValueError(
                f"reset of {self._name} must not depend on what an earlier episode left in its attributes, but after "
                f"an episode that ended in the state {state_text(self.attributes(last.state))}, it {found}"
            )

    def _reset(self, before: Any) -> Visit:
        env = self._copy(before)
        env.np_random = self._rng
        observation, info = env.reset()
        return self._visit(env, observation, info, "reset", terminated=False)

    def _step(self, state: Any, action: int, where: _Place) -> Outcome:
        env = self._copy(state)
        env.np_random = self._rng
        observation, reward, terminated, truncated, info = env.step(action)
        if truncated:
            raise ValueError(
                f"env must have its time limit in gymnasium.wrappers.TimeLimit, but step of {self._name} truncates the "
                f"episode {where}"
            )
        number = finite_reward(reward, f"step of {self._name}", where)
        visit = self._visit(env, observation, info, "step", terminated=bool(terminated))
        return Outcome(Fraction(1), visit, number, bool(terminated))

    def _visit(self, env: Any, observation: Any, info: Any, method: str, *, terminated: bool) -> Visit:
        if env._np_random is not self._rng:
            raise ValueError(
                f"env must keep the generator np_random that it is given, but {method} of {self._name} replaces it"
            )
        mask = None if terminated else self._mask(env, info)
        env._np_random = None
        return Visit(env, self._key(env), observation, mask)

    def _mask(self, env: Any, info: Any) -> NDArray[np.bool_] | None:
        given = env.action_masks() if hasattr(env, "action_masks") else info.get("action_mask")
        return None if given is None else checked_mask("action_mask", given, int(env.action_space.n))

    def _key(self, env: Any) -> Hashable:
        try:
            return attributes_key(env, self.attributes(env))
        except NotComparableError as error:
            raise ValueError(
                f"env must have attributes that can be compared, but in {self._name}, {error}. A qtab.FunctionalEnv "
                "names its state"
            ) from None

    def _refused(self, method: str, error: CannotListError, where: str) -> ValueError:
        return ValueError(
            f"env must have outcomes that can be listed, but {method} of {self._name} calls {error.reason}{where}. "
            "Write it as a qtab.FunctionalEnv with the methods outcomes and initial_outcomes, or as a qtab.TabularEnv"
        )
