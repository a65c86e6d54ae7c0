"""The error for a setting that does not exist, which names the one that was probably meant."""

import inspect
from collections.abc import Callable, Collection, Iterable
from functools import wraps
from typing import ParamSpec, TypeVar

from qtab._utils.shown import shown
from qtab._utils.suggestions import nearest

P = ParamSpec("P")
T = TypeVar("T")

_OTHER_NAMES = {
    "env": ("env_id", "env_name", "environment"),
    "env_kwargs": ("environment_kwargs", "make_kwargs"),
    "max_episode_steps": ("max_steps", "max_steps_per_episode", "time_limit", "horizon"),
    "episodes": ("n_episodes", "num_episodes", "max_episodes", "total_episodes", "n_eps"),
    "seed": ("random_seed", "random_state", "rng"),
    "algorithm": ("algo", "agent", "method"),
    "learning_rate": ("alpha", "lr", "step_size", "stepsize"),
    "discount": ("gamma", "discount_factor", "discount_rate"),
    "learning_rate_decay": ("alpha_decay", "lr_decay"),
    "learning_rate_schedule": ("alpha_schedule", "lr_schedule"),
    "min_learning_rate": ("alpha_min", "min_alpha", "min_lr", "lr_min"),
    "trace_decay": ("lam", "lambda_", "lambd", "lmbda", "td_lambda"),
    "traces": ("trace_type", "eligibility_traces"),
    "n_steps": ("n", "n_step"),
    "planning_steps": ("n_planning", "n_planning_steps", "planning"),
    "time_weight": ("kappa",),
    "sigma": ("sampling_degree",),
    "priority_threshold": ("theta", "priority_tolerance"),
    "reward_learning_rate": ("beta", "eta", "average_reward_rate", "reward_step_size"),
    "count_bonus": ("exploration_bonus", "bonus", "count_based_bonus"),
    "initial_q": ("init_q", "q_init", "q_table", "initial_value", "optimistic_value"),
    "exploration": ("policy", "policy_type", "behaviour_policy", "behavior_policy", "policy_kwargs"),
    "epsilon": ("eps", "exploration_rate", "epsilon_start", "eps_start", "exploration_initial_eps"),
    "min_epsilon": ("epsilon_min", "epsilon_end", "eps_min", "eps_end", "exploration_final_eps", "final_epsilon"),
    "epsilon_decay": ("eps_decay", "exploration_decay"),
    "ties": ("tie_breaking", "tie_break"),
    "temperature": ("tau",),
    "confidence": ("ucb_c", "c", "ucb"),
    "value_learning_rate": ("alpha_w", "critic_learning_rate", "critic_lr", "value_lr"),
    "discretizer": ("discretization", "features"),
    "bins": ("n_bins", "num_bins", "buckets"),
    "tilings": ("n_tilings", "num_tilings"),
    "tiles": ("n_tiles", "num_tiles", "tiles_per_dim"),
    "hashed_rows": ("iht_size", "hash_size", "memory_size"),
    "actions": ("n_actions", "num_actions"),
    # Arguments of the functions
    "seeds": ("n_seeds", "num_seeds", "n_runs", "num_runs", "runs"),
    "threads": ("n_jobs", "num_workers", "workers", "n_threads", "num_threads"),
    "progress": ("verbose", "progress_bar"),
}
"""What other libraries and textbooks call the settings."""
_STEPS = ("total_timesteps", "n_timesteps", "num_timesteps", "timesteps", "total_steps")


def check_names(names: Iterable[str], known: Collection[str], function: str = "train", kind: str = "setting") -> None:
    """Refuses unknown settings.

    Args:
        names: What was given.
        known: The settings, and any other arguments that could have been meant.
        function: The public function whose help lists them.
        kind: What they are, for the message.

    Raises:
        TypeError: names the first unknown setting and, where there is one, the nearest known one.
    """
    for name in names:
        if name not in known:
            raise TypeError(f"unknown {kind} {shown(name)}{_suggestion(name, known, function, kind)}")


def suggesting(function: Callable[P, T]) -> Callable[P, T]:
    """Makes a function suggest the argument that was probably meant by an unknown keyword."""
    known = inspect.signature(function).parameters

    @wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> T:
        check_names(kwargs, known, function.__name__, "argument")
        return function(*args, **kwargs)

    return checked


def meant(name: str, known: Collection[str]) -> str | None:
    """Returns the known name that was probably meant; None if there is none."""
    if name in _STEPS and "episodes" in known:
        return "episodes"
    names = {other: ours for ours, others in _OTHER_NAMES.items() if ours in known for other in others}
    names |= {word: word for word in known}
    found = name if name in names else nearest(name, names)
    return None if found is None else names[found]


def _suggestion(name: str, known: Collection[str], function: str, kind: str) -> str:
    found = meant(name, known)
    if found is None:
        command = " and qtab train --help list" if function == "train" else " lists"
        return f"; help(qtab.{function}){command} the {kind}s"
    counted = " qtab counts episodes, not steps" if name in _STEPS else ""
    return f" (did you mean {found!r}?{counted})"
