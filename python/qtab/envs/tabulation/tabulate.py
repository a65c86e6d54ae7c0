"""``qtab.tabulate``: the transition table of an environment with few states."""

import random
import sys
from collections.abc import Hashable
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.envs.functional import FunctionalEnv
from qtab.envs.in_rust.matching import layers, overridden, time_limit
from qtab.envs.origin.class_code import is_of_library
from qtab.envs.origin.describe import NEUTRAL, describe
from qtab.envs.registry import hint_for
from qtab.envs.tabulation.branches import CannotListError
from qtab.envs.tabulation.copied_outcomes import CopiedOutcomes
from qtab.envs.tabulation.functional_outcomes import FunctionalOutcomes
from qtab.envs.tabulation.known_table import has_known_table, tabulate_known
from qtab.envs.tabulation.state_keys import NotComparableError, state_key, state_text
from qtab.envs.tabulation.tabulated_env import MOST_NAMES, TabulatedEnv
from qtab.envs.tabulation.walk import Outcomes, Walk


def tabulate(env: gym.Env[Any, Any], *, max_states: int = 100_000) -> TabulatedEnv:
    """Makes the transition table of an environment with few states, by listing every outcome of every action.

    Rust steps the table, and :func:`qtab.optimum` computes its exact optimum. Probabilities are exact, or the
    environment is refused; they are never estimated.

    - An environment with ``P`` and ``initial_state_distrib``, such as Gymnasium's toy text, gives its own table,
      unchanged to the bit. Its methods ``reset`` and ``step`` must be those of Gymnasium's or qtab's class: sampled
      steps could not show that others have the same probabilities. For a class that overrides one of them, tabulate
      ``qtab.TabularEnv(env.P, env.initial_state_distrib)``.
    - For a :class:`qtab.FunctionalEnv`, the states that can be reached are visited breadth first. A transition that
      draws random numbers is repeated once for each combination of values. This works for ``integers``, ``choice``,
      ``permutation``, ``shuffle`` and ``binomial`` with few values, and for ``random()`` and ``uniform(low, high)`` if
      they are only compared with numbers, as in ``rng.random() < 0.1``. Any other draw needs the environment's methods
      ``outcomes`` and ``initial_outcomes``.
    - Any other environment is copied with ``copy.deepcopy``, and each copy is stepped once, with the same draws. Its
      state is all of its attributes, which must be numbers, texts, arrays, or collections and objects of these.

    States are numbered in the order in which they are found. The outcomes of an action are in the order of the drawn
    values, or in that of ``outcomes``. Equal outcomes are joined into one. A probability is computed as a fraction and
    rounded once to float64.

    The observation of the table is the number of the state, also where the environment's observation hides part of the
    state. Actions are counted from 0. The table has the time limit of the environment. With an action mask,
    ``action_mask=True`` trains with it; an unavailable action ends the episode with a reward below every possible
    return within the time limit and within 10,000 steps, so that no best policy takes it.

    Args:
        env: The environment. It is copied, and neither stepped nor closed. Wrappers of ``gymnasium.make`` and those
            that only record or show episodes are left out; its action space must be Discrete.
        max_states: The most states.

    Returns:
        The table, with the states, their observations and names, the time limit, and the masks.

    Raises:
        TypeError: if an argument has the wrong type, or a method of the environment returns one.
        ValueError: for more than ``max_states`` states, outcomes that cannot be listed, states that cannot be compared,
            an environment that truncates episodes itself, a functional one that overrides ``step`` or ``reset``, other
            action spaces, or wrappers that may change a number. The message names the state, the action and the draw.
    """
    if not isinstance(env, gym.Env):
        hint = f"; pass gymnasium.make({env!r})" if isinstance(env, str) else hint_for(env)
        raise TypeError(f"env must be an environment, got {shown(env)}{hint}")
    max_states = checks.count("max_states", max_states, least=1)
    for layer in layers(env):
        if isinstance(layer, gym.Wrapper) and type(layer) not in NEUTRAL:
            name = type(layer).__name__
            raise ValueError(f"env must have no wrapper that may change observations, actions or rewards, got {name}")
    unwrapped: Any = env.unwrapped
    if not isinstance(unwrapped.action_space, gym.spaces.Discrete):
        raise ValueError(f"env must have a Discrete action space, got {unwrapped.action_space}")
    limit = time_limit(env)
    table = _table(unwrapped, limit, max_states)
    table.made_of = describe(env)
    return table


def _table(env: Any, limit: int | None, max_states: int) -> TabulatedEnv:
    if has_known_table(env):
        return tabulate_known(env, limit, max_states)
    if not isinstance(env, FunctionalEnv):
        return _tabulated(CopiedOutcomes(env), env, limit, max_states)
    _check_not_overridden(env)
    return _tabulated(FunctionalOutcomes(env), env, limit, max_states)


def _check_not_overridden(env: FunctionalEnv) -> None:
    cls = type(env)
    found = overridden(cls, FunctionalEnv)
    replaced = next((name for name in ("reset", "step") if name in vars(env)), None)
    if found is not None or replaced is not None:
        made = f"its class {found[0].__name__} overrides {found[1]}" if found else f"its method {replaced} was replaced"
        raise ValueError(
            f"env must not override step or reset of qtab.FunctionalEnv, whose steps follow from its other methods, "
            f"but {made}"
        )


def _tabulated(outcomes: Outcomes, env: Any, limit: int | None, max_states: int) -> TabulatedEnv:
    space = env.action_space
    walk = Walk(outcomes, int(space.n), int(space.start), max_states)
    before, of_class = _other_generators(env), _class_attributes(type(env))
    distribution = walk.run()
    _check_unchanged(env, before)
    now = _class_attributes(type(env))
    changed = sorted(name for name in now.keys() | of_class if now.get(name) != of_class.get(name))
    if changed:
        raise ValueError(f"env must keep what changes in its own attributes, but its steps changed {changed[0]}")
    states = outcomes.plain_states([visit.state for visit in walk.visits])
    names = [state_text(state) for state in states] if len(states) <= MOST_NAMES else []
    table = TabulatedEnv(
        walk.table(limit),
        distribution,
        state_names=names,
        action_names=getattr(env, "action_names", ()),
        masks=walk.masks(),
        max_episode_steps=limit,
    )
    table.states, table.observations = tuple(states), tuple(visit.observation for visit in walk.visits)
    return table


def _class_attributes(cls: type) -> dict[str, Hashable]:
    """Returns the keys of the attributes of a class and its bases outside Gymnasium and qtab that can be compared."""
    found: dict[str, Hashable] = {}
    for base in cls.__mro__:
        if is_of_library(base) or base.__module__ in sys.stdlib_module_names:
            continue
        for name, value in vars(base).items():
            if not name.startswith("__"):
                try:
                    found[f"{base.__name__}.{name}"] = state_key(value)
                except NotComparableError:
                    continue
                except CannotListError:  # a random number
                    found[f"{base.__name__}.{name}"] = object()
    return found


def _other_generators(env: Any) -> dict[str, Any]:
    """Returns the states of the random generators that an environment must not use, by their names."""
    of_numpy: Any = np.random.get_state()  # noqa: NPY002 - the state that a wrong environment changes
    states: dict[str, Any] = {
        "the module np.random": (of_numpy[1].tobytes(), *of_numpy[2:]),
        "the module random": random.getstate(),
    }
    for name in ("action_space", "observation_space"):
        space: Any = getattr(env, name)
        states[f"its {name}"] = None if space._np_random is None else space._np_random.bit_generator.state
    return states


def _check_unchanged(env: Any, before: dict[str, Any]) -> None:
    now = _other_generators(env)
    used = [name for name, state in before.items() if now[name] != state]
    if used:
        raise ValueError(
            "env must draw its random numbers from the generator that it is given, but "
            f"{type(env).__name__} or another thread drew from {used[0]}"
        )
