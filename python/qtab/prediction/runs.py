"""The runs of a prediction: the policies, the features and the seeds, passed to Rust."""

import math
import time
from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab import _core
from qtab._utils import checks
from qtab._utils.memory import check_memory, memory_left
from qtab._utils.progress import ProgressBar
from qtab._utils.shown import counted, listed, shown
from qtab.discretizers import Discretizer
from qtab.planning.least_squares.lstdq import GivenFeatures
from qtab.planning.policies import GivenPolicy, as_followed, probabilities
from qtab.prediction.estimates import ValueEstimates
from qtab.prediction.learning_rates import LEAST_SQUARES, rate_settings
from qtab.prediction.observation_policies import ObservationPolicies, observation_policy, reads_observations
from qtab.prediction.settings import NEEDS_BEHAVIOR, OFF_POLICY, PredictionSettings
from qtab.prediction.state_features import initial_weights, state_features
from qtab.training.setup.resolved_run import ResolvedRun

BYTES_PER_WEIGHT = 8 + 4
"""The memory of a run in progress for each weight, besides the features: the weight and its number of updates."""
BYTES_OF_METHOD = {
    "td_lambda": 13,
    "true_online_td_lambda": 13,
    "offline_lambda_return": 8,
    "monte_carlo": 8,
    "importance_sampling": 16,
    "batch_td": 32,
    "off_policy_td": 16,
    "off_policy_td_lambda": 13,
    "gtd2": 24,
    "tdc": 24,
    "emphatic_td": 16,
    "lstd": 40,
}
"""The additional memory of a method for each weight: traces, the last visits, sums over the visits, other vectors."""


def run_prediction(
    resolved: ResolvedRun,
    space: gym.Space[Any] | None,
    settings: PredictionSettings,
    policy: GivenPolicy,
    behavior: GivenPolicy | None,
    features: GivenFeatures | None,
    seeds: Sequence[int],
    points: NDArray[np.uint64],
    threads: int,
    limit: int | None = None,
    progress: bool | None = False,
    weights_before: ArrayLike | None = None,
) -> tuple[ValueEstimates, list[tuple[int, Exception]]]:
    """Runs a prediction. Returns the estimates and the runs that failed, whose missing weights are NaN."""
    cells, actions = resolved.discretizer, resolved.actions
    _check_behavior(behavior, settings)
    by_observation = any(reads_observations(one, cells) for one in (policy, behavior) if one is not None)
    target = followed = policies = None
    if by_observation:
        evaluated = observation_policy("policy", policy, cells, actions)
        acting = evaluated if behavior is None else observation_policy("behavior", behavior, cells, actions)
        policies = ObservationPolicies(evaluated, acting)
    else:
        target = followed = as_followed(probabilities("policy", policy, space, cells, actions))
        if behavior is not None:
            followed = as_followed(probabilities("behavior", behavior, space, cells, actions))
        _check_covered(target, followed)
    found = state_features(features, cells, space, settings)
    n_weights = found.n_weights
    if not resolved.is_native and len(seeds) > 1:
        raise ValueError(f"seeds must be one seed for an environment that is stepped in Python, got {len(seeds)}")
    in_progress = n_weights * (BYTES_PER_WEIGHT + BYTES_OF_METHOD.get(settings.method, 0))
    in_progress += found.nbytes + _matrices(settings) * 8 * n_weights**2
    size = n_weights * len(seeds) * len(points) * 8 + min(threads, len(seeds)) * in_progress
    runs, recorded = counted(len(seeds), "run"), counted(len(points), "recorded episode")
    check_memory(f"{runs} of {settings.method!r} with {recorded} (record= keeps fewer)", size, limit)
    initial = initial_weights(weights_before, found, settings)
    weights = np.full((len(seeds), len(points), n_weights), np.nan)
    began = time.perf_counter()
    spec: Any = resolved.spec()
    spec["settings"] = {**spec["settings"], **rate_settings(vars(settings))}
    prediction: Any = {
        "method": settings.method_spec(),
        "target": target,
        "behavior": followed,
        "policies": None if policies is None else policies.spec(),
        "rows": found.rows,
        "vectors": found.vectors,
        "initial_weights": initial,
    }
    bar = ProgressBar(len(seeds) * settings.episodes, "episode", progress)
    with resolved.environment.exclusively(), bar:
        report = bar.move_to if bar.is_shown else None
        failed = _core.estimate_values(
            spec, prediction, seeds, points, weights, threads, report, memory_left(size, limit)
        )
        if not failed:
            bar.move_to(len(seeds) * settings.episodes)
    return ValueEstimates(
        env=resolved.config.env,
        settings=settings,
        seeds=tuple(seeds),
        episodes=points.astype(np.int64),
        weights=weights,
        rows=found.rows,
        probabilities=_by_cell(target, cells),
        behavior=_by_cell(followed, cells),
        config=resolved.config,
        seconds=time.perf_counter() - began,
        discretizer=cells,
        policies=policies,
        feature_vectors=found.vectors,
        initial_weights=initial,
    ), failed


def _check_behavior(behavior: GivenPolicy | None, settings: PredictionSettings) -> None:
    """Rejects a missing ``behavior`` off policy, and a given one for a method that evaluates the policy that acts."""
    method = settings.method
    if behavior is None and method in NEEDS_BEHAVIOR:
        raise ValueError(f"behavior must be given for method {method!r}, got None")
    if behavior is not None and method not in OFF_POLICY:
        raise ValueError(f"behavior applies to method {listed(OFF_POLICY)}, not to {method!r}, got {shown(behavior)}")


def _check_covered(target: NDArray[np.float64], followed: NDArray[np.float64]) -> None:
    missing = np.argwhere((target > 0.0) & (followed == 0.0))
    if len(missing):
        row, action = missing[0]
        raise ValueError(
            f"behavior must cover policy: it never takes action {action} in row {row}, which policy takes with "
            f"probability {target[row, action]:g}"
        )


def _matrices(settings: PredictionSettings) -> int:
    """The number of (n_weights, n_weights) arrays of a method."""
    return 0 if settings.method != LEAST_SQUARES else 1 if settings.recursive else 2


def _by_cell(table: NDArray[np.float64] | None, cells: Discretizer) -> NDArray[np.float64] | None:
    return None if table is None else table.reshape(*cells.shape, -1)


def recorded_episodes(record: Any, episodes: int, limit: int | None = None) -> NDArray[np.uint64]:
    """Returns (points,) uint64: the ascending numbers of episodes after which the weights are kept, including the last.

    Raises:
        TypeError: if ``record`` is not an integer or a sequence of integers.
        ValueError: if a number is out of range.
    """
    if record is None:
        record = 1
    if not checks.is_sequence(record):
        every = checks.count("record", record, least=1)
        count = math.ceil(episodes / every)
        check_memory(f"{counted(count, 'recorded episode')} (record= keeps fewer)", 8 * count, limit)
        points = np.arange(1, count + 1, dtype=np.uint64) * np.uint64(every)
        points[-1] = episodes
        return points
    numbers = sorted({checks.integer("record", number, least=0, most=episodes) for number in record} | {episodes})
    return np.array(numbers, dtype=np.uint64)
