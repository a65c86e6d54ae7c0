"""``qtab.optimum``: the best policy of an environment."""

import time
from collections.abc import Mapping
from contextlib import closing
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec

from qtab._utils import checks
from qtab._utils.progress import ProgressBar, check_progress
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.config.origin import trained_on
from qtab.config.unknown import suggesting
from qtab.envs.in_rust.matching import time_limit
from qtab.envs.metadata.goals import has_quick_optimum, reward_threshold
from qtab.envs.origin.describe import describe
from qtab.envs.origin.description import EnvironmentDescription
from qtab.envs.registry import UNLIMITED_MAX_EPISODE_STEPS, spec_of_run
from qtab.planning.classic_control import GridSolver, search_grid
from qtab.planning.grid_environments import GridEnvironment, grid_environment
from qtab.planning.optimum import Optimum
from qtab.planning.table import check_wrappers, has_transition_table, opened_env, table_of
from qtab.planning.tabular import METHODS, TabularSolver
from qtab.results.run import Run
from qtab.results.runs import Runs
from qtab.training.setup.run_env import make_run_env

SEARCH = "search"
SEARCH_STAGES = 2
"""The stages of a search: values on a grid, then routes."""


@suggesting
def optimum(
    env: str | EnvSpec | gym.Env | Run | Runs,
    *,
    discount: float | None = None,
    max_episode_steps: int | None = None,
    method: str | None = None,
    env_kwargs: Mapping[str, Any] | None = None,
    progress: bool | None = None,
) -> Optimum:
    """Computes the best policy of an environment, its values, and its expected return under the time limit.

    The result is exact for every environment with a transition table: toy text, :class:`qtab.TabularEnv`, any other
    environment with ``P`` and ``initial_state_distrib``, and Blackjack, whose table follows from its rules. For
    MountainCar, CartPole, Acrobot and Pendulum it is the best known policy: value iteration on a fine grid and, for
    MountainCar and Acrobot, also a search over the exact dynamics. Each route that it returns reaches the goal, but
    none is proven to be the shortest. CartPole's policy never falls, so no policy returns more.

    Args:
        env: A Gymnasium id, an ``EnvSpec`` or an environment, which is neither stepped nor closed; or a run, whose
            environment, keyword arguments and time limit are used.
        discount: The discount of the values and the policy, in [0, 1]; None means 1, no discount.
        max_episode_steps: The time limit in steps; None means the environment's own limit, or 10,000, as in training.
        method: With a transition table, ``"finite_horizon"`` (the default; backward induction over the time limit, so
            no policy returns more), ``"value_iteration"`` (Sutton & Barto, 2nd ed., eq. 4.10) or ``"policy_iteration"``
            (section 4.3). The last two give the best policy that ignores the time limit, and its values; without a
            discount, policy iteration considers only policies that end the episode, and value iteration also those that
            stay in states without rewards. For classic control, ``"search"``.
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.
        progress: Whether to show a progress bar over the stages of the search. None shows one on a terminal or in a
            notebook if it takes more than a second.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        OverflowError: if values exceed the range of float64.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, an environment whose optimum is not known, or values that are
            unbounded without a discount.
    """
    check_progress(progress)
    if max_episode_steps is not None:
        max_episode_steps = checks.count("max_episode_steps", max_episode_steps, least=1)
    if isinstance(env, Run | Runs):
        return _optimum_for_run(env, discount, max_episode_steps, method, env_kwargs, progress)
    known = "an environment id, an EnvSpec, an environment or a run"
    with opened_env(env, env_kwargs, known) as (name, opened):
        description = None if opened is env else describe(opened, is_new=True)
        return _optimum_for_env(name, opened, max_episode_steps, discount, method, progress, description)


def _optimum_for_run(
    run: Run | Runs,
    discount: float | None,
    max_episode_steps: int | None,
    method: str | None,
    env_kwargs: Mapping[str, Any] | None,
    progress: bool | None,
) -> Optimum:
    config = run.config
    if env_kwargs is not None:
        raise ValueError(f"env_kwargs must be None with a run, which has its own, got {shown(env_kwargs)}")
    try:
        spec_of_run(config.env)
    except gym.error.Error:
        raise ValueError(
            f"env must be an environment object for this run: its environment {config.env!r} is not a registered id"
        ) from None
    with closing(make_run_env(config, of="gymnasium")) as made:
        limit = max_episode_steps or config.max_episode_steps
        return _optimum_for_env(config.env, made, limit, discount, method, progress, trained_on(config))


def _optimum_for_env(
    name: str,
    env: gym.Env,
    max_episode_steps: int | None,
    discount: float | None,
    method: str | None,
    progress: bool | None,
    description: EnvironmentDescription | None = None,
) -> Optimum:
    started = time.perf_counter()
    unwrapped: Any = env.unwrapped
    check_wrappers(env)
    discount = 1.0 if discount is None else checks.real("discount", discount, 0.0, 1.0)
    on_grid = grid_environment(unwrapped)
    if on_grid is None and not has_transition_table(unwrapped):
        raise ValueError(
            "env must have a transition table P and an initial_state_distrib, or be Blackjack, MountainCar, CartPole, "
            f"Acrobot or Pendulum: the optimum of {name} is not known; qtab.tabulate(env) makes the table of an "
            "environment with few states"
        )
    methods = METHODS if on_grid is None else (SEARCH,)
    method = methods[0] if method is None else checks.choice("method", method, methods)
    steps = max_episode_steps or time_limit(env) or UNLIMITED_MAX_EPISODE_STEPS
    environment = description or describe(env)
    with ProgressBar(1 if on_grid is None else SEARCH_STAGES, "stage", progress, "optimum") as bar:
        if on_grid is not None:
            best = _search_grid(unwrapped, on_grid, discount, steps, bar)
        else:
            best = _solve_table(unwrapped, method, discount, steps)
            bar.move_to(1)
    return Optimum(
        env=name,
        env_kwargs={} if env.spec is None else dict(env.spec.kwargs),
        max_episode_steps=steps,
        method=method,
        exact=on_grid is None,
        discount=discount,
        reward_threshold=None if env.spec is None else reward_threshold(name, env.spec.kwargs, steps, environment),
        seconds=time.perf_counter() - started,
        environment=environment,
        **best,
    )


def _solve_table(env: Any, method: str, discount: float, max_episode_steps: int) -> dict[str, Any]:
    """Returns the fields of an :class:`Optimum` that depend on the method."""
    table = table_of(env)
    cells = table.cells
    solver = TabularSolver(table, method, discount, max_episode_steps)
    # The first states are those that observations show. If these hide part of the state, the hidden variants follow.
    observed = slice(cells.n_rows)
    return {
        "values": solver.values[observed].reshape(cells.shape),
        "q_values": solver.q_values[observed].reshape(*cells.shape, -1),
        "policy": solver.policy[observed].reshape(cells.shape) + table.actions.first,
        "expected_return": solver.expected_return,
        "solver": solver,
        "search": None,
    }


def _search_grid(
    env: Any, known: GridEnvironment, discount: float, max_episode_steps: int, bar: ProgressBar
) -> dict[str, Any]:
    """Returns the fields of an :class:`Optimum` that depend on the method."""
    if discount != 1.0:
        raise ValueError(f"discount must be 1 for method 'search', got {shown(discount)}")
    searched, search = search_grid(env, known, max_episode_steps, on_values=lambda: bar.move_to(1))
    bar.move_to(SEARCH_STAGES)
    values, action_values = searched.values()
    shape = tuple(map(len, search.axes))
    q_values = action_values.reshape(*shape, -1)
    return {
        "values": values.reshape(shape),
        "q_values": q_values,
        "policy": np.argmax(q_values, axis=-1),
        "expected_return": float(search.returns.mean()),
        "solver": GridSolver(searched, known, search),
        "search": search,
    }


def quick_optimum(config: Config, n_rows: int, n_actions: int) -> Optimum | None:
    """Returns the optimum of a resolved config's environment; None without a known table, or if it takes a second.

    Args:
        config: The config.
        n_rows: The number of rows of the run's table.
        n_actions: The number of actions.
    """
    known = trained_on(config)
    is_changed = known is not None and (known.table is not None or bool(known.wrappers))
    if is_changed or not has_quick_optimum(config, n_rows, n_actions):
        return None
    return optimum(config.env, env_kwargs=config.env_kwargs, max_episode_steps=config.max_episode_steps)
