"""The outcomes of a :class:`qtab.FunctionalEnv`: as it lists them, or one by one for each value of its draws."""

import copy
import math
from collections.abc import Callable, Hashable, Iterable, Sequence
from fractions import Fraction
from functools import cached_property
from inspect import getattr_static
from types import BuiltinFunctionType, FunctionType, MethodType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import shown
from qtab.envs.functional import FunctionalEnv
from qtab.envs.functional.observations import observation_in
from qtab.envs.tabulation.branches import Branches, CannotListError
from qtab.envs.tabulation.generator import ListingGenerator
from qtab.envs.tabulation.listed_steps import finite_reward, listed
from qtab.envs.tabulation.state_keys import NotComparableError, attributes_key, state_key, state_text
from qtab.envs.tabulation.walk import Outcome, Visit

_SAMPLES = 2
"""The sampled transitions that must be among the listed outcomes of each state and action."""
_INITIAL_SAMPLES = 50
_OF_BASE = ("_state", "_structure", "_np_random", "_np_random_seed", "spec")
"""Attributes that the base class or ``gymnasium.make`` sets."""
_TOLERANCE = 1e-9
"""How far the sum of listed probabilities may be from 1, as for :class:`qtab.TabularEnv`."""


class FunctionalOutcomes:
    """The outcomes of a functional environment.

    Args:
        env: The environment. It is copied, and not stepped.

    Raises:
        ValueError: if it has an attribute that cannot be compared.
    """

    name_of_state = "state"

    def __init__(self, env: FunctionalEnv) -> None:
        self._branches = Branches()
        self._name = type(env).__name__
        self._rng = ListingGenerator(self._branches)
        self._sampler = np.random.default_rng(0)
        self._env = _copied(env)
        self._env.np_random, self._env.render_mode = self._rng, None
        self._before = _attributes(self._env)
        self._visits: dict[tuple[Hashable, bool], Visit] = {}
        """The states that were found, by their keys and whether they are terminal."""
        self._outcomes: Callable[[Any, int], Any] | None = _method(self._env, "outcomes")
        self._initial_outcomes: Callable[[], Any] | None = _method(self._env, "initial_outcomes")

    def initial(self) -> list[tuple[Fraction, Visit]]:
        """Returns the first states of an episode with their probabilities.

        Raises:
            TypeError: if ``initial_outcomes`` returns values of other types than it should.
            ValueError: if the first states cannot be listed, or are not those that ``initial_outcomes`` lists.
        """
        if self._initial_outcomes is not None:
            return self._listed_initial(self._initial_outcomes())
        try:
            return list(self._branches.outcomes(self._reset))
        except CannotListError as error:
            raise ValueError(
                f"env must have initial states that can be listed, but initial_state of {self._name} calls "
                f"{error.reason}. Add the method initial_outcomes(self), which returns a list of (probability, state)"
            ) from None

    def step(self, state: Any, action: int) -> list[Outcome]:
        """Returns the outcomes of an action.

        Raises:
            TypeError: if ``outcomes`` returns values of other types than it should.
            ValueError: if the outcomes cannot be listed, are not those that ``outcomes`` lists, or depend on more than
                the state.
        """
        where = f"in state {state_text(state)} for action {action}"
        if self._outcomes is not None:
            return self._listed(self._outcomes(state, action), state, action, where)
        before = self._key(state)

        def take() -> Outcome:
            return self._step(self._rng, state, action, where)

        try:
            found, repeated = listed(self._branches, take)
        except CannotListError as error:
            raise ValueError(
                f"env must have outcomes that can be listed, but transition of {self._name} calls {error.reason}, "
                f"{where}. Add the method outcomes(self, state, action), which returns a list of (probability, state, "
                "reward, terminated)"
            ) from None
        if self._key(state) != before:
            raise ValueError(
                f"transition of {self._name} must not change the state that it is given, as it did {where}"
            )
        if not repeated:
            raise ValueError(
                f"transition of {self._name} must depend only on its arguments: a repeated call with the same random "
                f"numbers returned another result, {where}"
            )
        return found

    def plain_states(self, states: Sequence[Any]) -> list[Any]:
        """Returns the states."""
        return list(states)

    def check_unchanged(self) -> None:
        """Checks that the methods did not change attributes of the environment.

        Raises:
            ValueError: if they did. The message names the attribute.
        """
        now = _attributes(self._env)
        before = _cached_properties(self._env, now.keys() - self._before) | self._before
        changed = next((name for name in sorted(now.keys() | before) if now.get(name) != before.get(name)), "")
        if changed:
            raise ValueError(
                f"env must keep what changes in its state, but a method of {self._name} changed self.{changed}"
            )

    def _reset(self) -> Visit:
        self._env.reset()
        return self._visit(self._env.state, terminated=False)

    def _step(self, rng: np.random.Generator, state: Any, action: int, where: str) -> Outcome:
        returned: Any = self._env.transition(state, action, rng)
        name = f"transition of {self._name}"
        if not isinstance(returned, tuple) or len(returned) != 3:
            raise TypeError(f"{name} must return (state, reward, terminated), got {shown(returned)} {where}")
        next_state, reward, terminated = returned
        return self._outcome(Fraction(1), next_state, reward, terminated, name, where)

    def _outcome(
        self, probability: Fraction, state: Any, reward: Any, terminated: Any, name: str, where: str
    ) -> Outcome:
        if not isinstance(terminated, bool | np.bool_):
            raise TypeError(f"{name} must return a boolean as terminated, got {shown(terminated)} {where}")
        number = finite_reward(reward, name, where)
        return Outcome(probability, self._visit(state, bool(terminated)), number, bool(terminated))

    def _visit(self, state: Any, terminated: bool) -> Visit:
        """Returns a state with its observation and its mask, which are computed once."""
        key = self._key(state)
        visit = self._visits.get((key, terminated))
        if visit is None:
            visit = self._visits[key, terminated] = Visit(state, key, *self._seen(state, terminated))
        return visit

    def _seen(self, state: Any, terminated: bool) -> tuple[Any, NDArray[np.bool_] | None]:
        env = self._env
        if terminated:
            return observation_in(env.observation_space, env.observe(state), f"observe of {self._name}"), None
        observation, info = env.reset(options={"state": state})
        mask = info.get("action_mask")
        return observation, None if mask is None else mask.astype(np.bool_)

    def _listed_initial(self, given: Any) -> list[tuple[Fraction, Visit]]:
        name = f"initial_outcomes of {self._name}"
        if not isinstance(given, list | tuple) or not all(isinstance(one, tuple) and len(one) == 2 for one in given):
            raise TypeError(f"{name} must return a list of (probability, state), got {shown(given)}")
        chances = _probabilities(name, "", [one[0] for one in given])
        found = [
            (chance, self._visit(one[1], terminated=False))
            for chance, one in zip(chances, given, strict=True)
            if chance
        ]
        known = {visit.key for _, visit in found}
        for _ in range(_INITIAL_SAMPLES):
            sampled = self._env.initial_state(self._sampler)
            if self._key(sampled) not in known:
                raise ValueError(
                    f"{name} must list every first state, but initial_state returned {state_text(sampled)}"
                )
        return found

    def _listed(self, given: Any, state: Any, action: int, where: str) -> list[Outcome]:
        name = f"outcomes of {self._name}"
        if not isinstance(given, list | tuple) or not all(isinstance(one, tuple) and len(one) == 4 for one in given):
            raise TypeError(
                f"{name} must return a list of (probability, state, reward, terminated), got {shown(given)} {where}"
            )
        chances = _probabilities(name, f" {where}", [one[0] for one in given])
        found = [
            self._outcome(chance, next_state, reward, terminated, name, where)
            for chance, (_, next_state, reward, terminated) in zip(chances, given, strict=True)
            if chance
        ]
        known = {one.identity for one in found}
        for _ in range(_SAMPLES):
            sampled = self._step(self._sampler, state, action, where)
            if sampled.identity not in known:
                raise ValueError(
                    f"{name} must list every outcome of transition, which returned state "
                    f"{state_text(sampled.visit.state)}, reward {sampled.reward!r} and terminated "
                    f"{sampled.terminated} {where}"
                )
        return found

    def _key(self, state: Any) -> Hashable:
        try:
            key: Hashable = state_key(state)
        except NotComparableError as error:
            raise ValueError(
                f"env must have states of numbers, tuples and arrays, but in {self._name}, {error}"
            ) from None
        return key


def _copied(env: FunctionalEnv) -> FunctionalEnv:
    """Returns a copy with copies of the attributes, which methods may change by mistake; shallow if there are none."""
    shared = (env.observation_space, env.action_space, env.metadata, env.spec)
    try:
        return copy.deepcopy(env, {id(one): one for one in shared})
    except Exception:  # copying runs code of any class
        return copy.copy(env)


def _attributes(env: FunctionalEnv) -> dict[str, Hashable]:
    """Returns the keys of the attributes, without those of Gymnasium and of the base class.

    Raises:
        ValueError: for an attribute that cannot be compared, since methods could change it unseen.
    """
    return {name: _attribute_key(env, name, value) for name, value in vars(env).items() if name not in _OF_BASE}


def _attribute_key(env: FunctionalEnv, name: str, value: Any) -> Hashable:
    if isinstance(value, FunctionType | MethodType | BuiltinFunctionType):
        return id(value)
    if isinstance(value, float | np.floating) and math.isnan(value):
        return "NaN"
    try:
        return attributes_key(env, {name: value})
    except CannotListError:  # a random number, which differs from every other value
        return object()
    except (NotComparableError, RecursionError) as error:
        reason = f"self.{name} is nested too deeply" if isinstance(error, RecursionError) else error
        raise ValueError(
            f"env must have attributes that can be compared, but in {type(env).__name__}, {reason}; what changes in an "
            "episode belongs in the state"
        ) from None


def _cached_properties(env: FunctionalEnv, names: Iterable[str]) -> dict[str, Hashable]:
    """Returns, for the names that are cached properties, the values that they have when they are computed again."""
    found: dict[str, Hashable] = {}
    for name in names:
        cached = getattr_static(type(env), name, None)
        if isinstance(cached, cached_property):
            found[name] = _attribute_key(env, name, cached.func(env))
    return found


def _method(env: FunctionalEnv, name: str) -> Callable[..., Any] | None:
    """Returns a method of an environment; None if its class has none."""
    return getattr(env, name) if callable(getattr(type(env), name, None)) else None


def _probabilities(name: str, where: str, given: list[Any]) -> list[Fraction]:
    chances: list[Fraction]
    try:
        chances = [one if isinstance(one, Fraction) else Fraction(float(one)) for one in given]
    except (OverflowError, TypeError, ValueError):  # infinity, no number, NaN
        chances = [Fraction(-1)]
    if not all(0 <= one <= 1 for one in chances):
        raise ValueError(f"{name} must have probabilities in [0, 1], got {shown(given)}{where}")
    total = sum(chances, Fraction(0))
    if abs(float(total) - 1.0) > _TOLERANCE:
        raise ValueError(f"{name} must have probabilities that sum to 1, got {float(total)!r}{where}")
    return chances
