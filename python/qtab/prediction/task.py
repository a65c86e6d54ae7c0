"""The task of a prediction: the environment, and the division of its observations into states or tilings."""

from collections.abc import Mapping
from contextlib import closing
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec

from qtab._utils.shown import shown
from qtab.discretizers.box import BoxDiscretizer
from qtab.planning.classic_control import GridSolver
from qtab.planning.optimum import Optimum
from qtab.planning.policies import GivenPolicy
from qtab.prediction.learning_rates import LEAST_SQUARES
from qtab.prediction.settings import PredictionSettings
from qtab.prediction.storage import DISCRETIZER, OF_WEIGHTED
from qtab.results.run import Run
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import ResolvedRun

OF_OBSERVATIONS = (*DISCRETIZER, *OF_WEIGHTED, "actions")
"""The settings of a run that map observations to features, and actions to columns."""


def resolve_prediction(
    env: Any,
    policy: GivenPolicy,
    settings: PredictionSettings,
    seed: int,
    given: Mapping[str, Any],
    *,
    reads_space: bool = False,
) -> tuple[ResolvedRun, gym.Space[Any] | None]:
    """Returns the task of a prediction as a run, and its observation space if a function needs it.

    Args:
        env: The argument of :func:`qtab.estimate_values`.
        policy: The policy, which is one such function.
        settings: The settings of the prediction.
        seed: The seed of the task.
        given: The settings of the task.
        reads_space: Whether there is another such function.
    """
    brought = _of_policy(policy, given)
    made = env
    if not isinstance(env, gym.Env | str | EnvSpec):
        if not callable(env):
            raise TypeError(
                f"env must be an environment id, an EnvSpec, an environment or a function, got {shown(env)}"
            )
        made = env()
        if not isinstance(made, gym.Env):
            raise TypeError(f"env must make an environment, got {shown(made)}")
    if settings.method == LEAST_SQUARES and {**brought, **given}.get("discretizer") == "fourier":
        brought = {**brought, "scale_step_sizes": False}  # there are no step sizes
    resolved = resolve(made, {**settings.config(), **brought, **given, "seed": seed}, owns_env=made is not env)
    cells = resolved.discretizer
    if cells.reads_space or not (cells.has_cells or isinstance(cells, BoxDiscretizer)):
        raise ValueError(f"env must have discrete observations or a Box with one axis of floats, got {cells!r}")
    is_needed = (callable(policy) or reads_space) and not isinstance(cells, BoxDiscretizer)
    if isinstance(made, gym.Env) or not is_needed:
        return resolved, made.observation_space if isinstance(made, gym.Env) else None
    # A function of the observation must receive observations of the right type.
    with closing(gym.make(made, **dict(given.get("env_kwargs", {})))) as again:
        return resolved, again.observation_space


def _of_policy(policy: GivenPolicy, given: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings that come with the policy: a run's actions and, if none is given, its discretizer."""
    if isinstance(policy, Run):
        config = policy.config
        names = ("shape", *OF_OBSERVATIONS) if given.keys().isdisjoint(OF_OBSERVATIONS[:-1]) else ("actions",)
        return {name: getattr(config, name) for name in names}
    if isinstance(policy, Optimum) and isinstance(policy.solver, GridSolver) and policy.solver.has_continuous_actions:
        return {"actions": policy.q_values.shape[-1]}
    return {}
