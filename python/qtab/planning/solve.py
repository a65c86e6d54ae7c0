"""``qtab.optimum``: from an environment to the best that can be done in it."""

import time
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.classic_control.mountain_car import MountainCarEnv
from gymnasium.envs.registration import EnvSpec
from gymnasium.envs.toy_text.blackjack import BlackjackEnv

from qtab import _core
from qtab._utils import checks
from qtab.discretizers.actions import actions
from qtab.discretizers.identity import cells
from qtab.envs.classic_control import MountainCarEnv as RustMountainCarEnv
from qtab.envs.matching import time_limit, unknown_wrapper
from qtab.envs.native import toy_text_spec
from qtab.envs.registry import spec_of, versioned
from qtab.planning.mountain_car import ValleyTruth, search
from qtab.planning.optimum import Optimum
from qtab.planning.tables import METHODS, TableTruth, solve
from qtab.results.run import Run
from qtab.results.runs import Runs
from qtab.training.resolve import UNLIMITED_MAX_EPISODE_STEPS

SEARCH = "search"


def optimum(
    env: str | EnvSpec | gym.Env | Run | Runs,
    *,
    discount: float | None = None,
    max_episode_steps: int | None = None,
    method: str | None = None,
    env_kwargs: Mapping[str, Any] | None = None,
) -> Optimum:
    """Computes the best policy of an environment, its values and its expected return under the time limit.

    Exact for every environment with a transition table: toy text, :class:`qtab.TabularEnv`, anything with ``P`` and
    ``initial_state_distrib``, and Blackjack, whose table follows from its rules. For MountainCar-v0 it is the best that
    is known: a search over the exact dynamics, whose routes can be driven, but are not proved to be the shortest.

    Args:
        env: A Gymnasium id, an ``EnvSpec`` or an environment, which is neither stepped nor closed; or a run, whose
            environment, keyword arguments and time limit are taken.
        discount: What ``values`` and the policy count a later reward; None means 1, no discount.
        max_episode_steps: The time limit; None takes the environment's own, or else that of training, 10,000.
        method: ``"finite_horizon"``, backward induction over the time limit (the default: nothing returns more);
            ``"value_iteration"`` (Sutton & Barto, 2nd ed., eq. 4.10) or ``"policy_iteration"`` (section 4.3), the best
            policy that does not look at the clock, without a discount the latter the best of those that end;
            ``"search"`` for MountainCar-v0.
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.

    Raises:
        gymnasium.error.Error: Gymnasium's own, for an id that it does not know.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, an environment whose optimum is not known, or values that grow for
            ever without a discount.
    """
    if isinstance(env, Run | Runs):
        return _of_run(env, discount, max_episode_steps, method, env_kwargs)
    if max_episode_steps is not None:
        max_episode_steps = checks.count("max_episode_steps", max_episode_steps, least=1)
    if isinstance(env, gym.Env):
        if env_kwargs is not None:
            raise ValueError(f"env_kwargs must be None with an environment, which is made already, got {env_kwargs!r}")
        name = env.spec.id if env.spec is not None else type(env.unwrapped).__name__
        return _solve(name, env, max_episode_steps, discount, method)
    if not isinstance(env, str | EnvSpec):
        raise TypeError(f"env must be an environment id, an EnvSpec, an environment or a run, got {env!r}")
    name = env.id if isinstance(env, EnvSpec) else versioned(env)
    spec = env if isinstance(env, EnvSpec) else spec_of(name)
    made = gym.make(spec, **(env_kwargs or {}))
    try:
        return _solve(name, made, max_episode_steps, discount, method)
    finally:
        made.close()


def _of_run(
    run: Run | Runs,
    discount: float | None,
    max_episode_steps: int | None,
    method: str | None,
    env_kwargs: Mapping[str, Any] | None,
) -> Optimum:
    config = run.config
    if env_kwargs is not None:
        raise ValueError(f"env_kwargs must be None with a run, which has its own, got {env_kwargs!r}")
    try:
        spec_of(config.env)
    except gym.error.Error:
        raise ValueError(
            f"env must be the environment itself: the run is of {config.env!r}, an id that is not registered"
        ) from None
    return optimum(
        config.env,
        discount=discount,
        max_episode_steps=max_episode_steps or config.max_episode_steps,
        method=method,
        env_kwargs=config.env_kwargs,
    )


def _solve(name: str, env: gym.Env, limit: int | None, discount: float | None, method: str | None) -> Optimum:
    began = time.perf_counter()
    inner: Any = env.unwrapped
    wrapper = unknown_wrapper(env)
    if wrapper is not None:
        raise ValueError(f"env must have no wrapper that may change it, got {wrapper}")
    discount = 1.0 if discount is None else checks.real("discount", discount, 0.0, 1.0)
    car = type(inner) in (MountainCarEnv, RustMountainCarEnv)
    table = isinstance(inner, BlackjackEnv) or (hasattr(inner, "P") and hasattr(inner, "initial_state_distrib"))
    if not car and not table:
        raise ValueError(
            "env must have a transition table P and an initial_state_distrib, or be Blackjack or MountainCar-v0: the "
            f"optimum of {name} is not known"
        )
    methods = (SEARCH,) if car else METHODS
    method = methods[0] if method is None else checks.choice("method", method, methods)
    steps = limit or time_limit(env) or UNLIMITED_MAX_EPISODE_STEPS
    spec = env.spec
    common: dict[str, Any] = {
        "env": name,
        "env_kwargs": {} if spec is None else dict(spec.kwargs),
        "max_episode_steps": steps,
        "method": method,
        "exact": not car,
        "discount": discount,
        "reward_threshold": None if spec is None else spec.reward_threshold,
    }
    found = _search(inner, steps, discount) if car else _plan(inner, method, discount, steps)
    return Optimum(**common, **found, seconds=time.perf_counter() - began)


def _plan(env: Any, method: str, discount: float, steps: int) -> dict[str, Any]:
    table = cells(env, actions(env.action_space, None))
    planner = _core.Planner(toy_text_spec(env))
    solution = solve(planner, method, discount, steps)
    # The first states are those that an observation shows; what follows is hidden behind them.
    if len(solution.values) < table.rows or solution.q_values.shape[1] != table.actions:
        raise ValueError(f"P must have {table.rows} states of {table.actions} actions, as the spaces of env have")
    shape = table.shape[:-1]
    return {
        "values": solution.values[: table.rows].reshape(shape),
        "q_values": solution.q_values[: table.rows].reshape(table.shape),
        "policy": solution.policy[: table.rows].reshape(shape) + table.first_action,
        "expected_return": solution.expected_return,
        "search": None,
        "truth": TableTruth(planner, table, solution, steps),
    }


def _search(env: Any, steps: int, discount: float) -> dict[str, Any]:
    if discount != 1.0:
        raise ValueError(f"discount must be 1 for the search, which counts steps, got {discount!r}")
    names = _core.parameter_names("MountainCar")
    valley = _core.Valley([(name, checks.finite(name, getattr(env, name))) for name in names], steps)
    found = search(valley, steps)
    left, action_left = valley.steps()
    shape = (len(found.positions), len(found.velocities))
    q_values = -action_left.reshape(*shape, -1)
    return {
        "values": -left.reshape(shape),
        "q_values": q_values,
        "policy": np.argmax(q_values, axis=-1),
        "expected_return": -float(found.steps.mean()),
        "search": found,
        "truth": ValleyTruth(valley),
    }
