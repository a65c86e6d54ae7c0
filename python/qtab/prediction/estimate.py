"""``qtab.estimate_values``: estimates the values of a given policy from episodes, with many seeds at once."""

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from typing import Any, cast

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import ArrayLike, NDArray

from qtab import _core
from qtab._utils import checks
from qtab._utils.memory import check_memory, memory_limit
from qtab._utils.shown import shown
from qtab.config.choices import LearningRateSchedule
from qtab.config.unknown import suggesting
from qtab.planning.policies import GivenPolicy, probabilities
from qtab.prediction.estimates import ValueEstimates
from qtab.prediction.features import feature_rows
from qtab.prediction.learning_rates import AVERAGES_ONLY, schedule_of
from qtab.prediction.settings import Method, PredictionSettings
from qtab.results.run import Run
from qtab.training.resolve import log_default_limit, log_python_stepping, resolve
from qtab.training.resolved_run import ResolvedRun
from qtab.training.train_many import seed_sequence, thread_count

_DISCRETIZER = ("discretizer", "shape", "scale", "bins", "edges", "low", "high", "actions")
"""The settings of a run by which its observations index the table: a policy that is a run brings them along."""


@suggesting
def estimate_values(
    env: str | EnvSpec | gym.Env | Callable[[], gym.Env],
    policy: GivenPolicy,
    *,
    method: Method = "td",
    episodes: int = 100,
    learning_rate: float | None = None,
    learning_rate_schedule: LearningRateSchedule | None = None,
    min_learning_rate: float | None = None,
    learning_rate_decay: float | None = None,
    learning_rate_warm_up: int | None = None,
    discount: float = 1.0,
    n_steps: int | None = None,
    trace_decay: float | None = None,
    first_visit: bool | None = None,
    weighted: bool | None = None,
    behavior: GivenPolicy | None = None,
    features: ArrayLike | None = None,
    initial_value: float = 0.0,
    on_truncation: str = "bootstrap",
    bit_generator: str = "PCG64",
    seeds: int | Iterable[int] = 1,
    record: int | Sequence[int] | None = None,
    max_episode_steps: int | None = None,
    env_kwargs: Mapping[str, Any] | None = None,
    threads: int | None = None,
) -> ValueEstimates:
    """Estimates the values of a policy from episodes that follow it. This is prediction; :func:`qtab.train` is control.

    Environments in Rust run on threads, with any number of seeds. One that is stepped in Python takes a single seed.

    Args:
        env: An environment's id, its EnvSpec, an environment, or a function that makes one. Its observations must be
            discrete, unless the policy is a run, whose discretizer is then used.
        policy: ``"random"`` for equal probabilities; an array (*cells,) of actions or (*cells, actions) of
            probabilities; a function from an observation to an action or to (actions,) probabilities; a run, for its
            greedy policy; or an optimum that does not depend on the steps left.
        method: ``"td"`` is TD(0) (Sutton & Barto, 2nd ed., eq. 6.2), ``"n_step_td"`` eq. 7.2, ``"td_lambda"`` and
            ``"true_online_td_lambda"`` the boxes in sections 12.2 and 12.5, ``"offline_lambda_return"`` eq. 12.4,
            ``"monte_carlo"`` eq. 6.1 and the box in section 5.1, ``"importance_sampling"`` eqs. 5.5 and 5.6,
            ``"batch_td"`` section 6.3. Batch Monte Carlo is ``"monte_carlo"`` without a learning rate.
        episodes: The number of episodes.
        learning_rate: α, in [0, 2]: the fraction of the error that an update corrects; the active features share it.
            None takes 1 / n at the n-th visit of a feature, so that Monte Carlo values are averages of returns.
        learning_rate_schedule: How it falls: ``"linear"`` or ``"exponential"`` over the episodes, or ``"visits"``, as
            learning_rate / n at the n-th visit of a feature, for methods without traces; None means ``"constant"``, or
            ``"visits"`` without a learning rate.
        min_learning_rate: The lowest learning rate of a schedule, in [0, learning_rate]; None means 0.
        learning_rate_decay: The factor of ``"exponential"`` after each episode, in [0, 1]; None means 0.999.
        learning_rate_warm_up: The number of episodes before ``"linear"`` or ``"exponential"`` begins; None means 0.
        discount: γ, in [0, 1].
        n_steps: n, at least 1: the number of rewards in a target of ``"n_step_td"``.
        trace_decay: λ, in [0, 1]: the decay of traces and of λ-returns.
        first_visit: Whether only the first visit of a state in an episode counts, for ``"monte_carlo"`` and
            ``"importance_sampling"``; None means every visit.
        weighted: Whether importance sampling is weighted or ordinary; None means weighted.
        behavior: The policy that chooses the actions, for ``"importance_sampling"``, in the same forms as ``policy``.
            It must be able to take every action that ``policy`` can take.
        features: None for a table; or (states,) or (states, n_active) integers: the features that are active in each
            state, as :func:`qtab.prediction.state_aggregation` and :func:`qtab.prediction.tile_coding` return them.
        initial_value: The value of every state before the first episode.
        on_truncation: Where the time limit ends an episode: the returns continue with the value of the last state
            (``"bootstrap"``), or end there (``"terminate"``).
        bit_generator: The random generator of the policy, ``"PCG64"`` or ``"MT19937"``.
        seeds: The seeds of the runs; an integer N means 0 to N - 1.
        record: After how many episodes the weights are kept: an integer means each time after so many, a sequence lists
            the numbers, 0 for those before the first; None means after every episode.
        max_episode_steps: The time limit in steps; None means the environment's own, or 10,000.
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.
        threads: The number of threads; None means one per core. It does not change the results.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        MemoryError: if what is recorded would take more than half of the machine's memory.
        OverflowError: if the values of a run overflow, because ``learning_rate`` or ``trace_decay`` is too large.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range or that does not apply to the method, a policy of the wrong shape or
            with probabilities that do not sum to 1, or a ``behavior`` that does not cover it.
        KeyboardInterrupt: on Ctrl-C.
    """
    settings = PredictionSettings(
        method=method,
        episodes=episodes,
        learning_rate=learning_rate,
        learning_rate_schedule=learning_rate_schedule,
        min_learning_rate=min_learning_rate,
        learning_rate_decay=learning_rate_decay,
        learning_rate_warm_up=learning_rate_warm_up,
        discount=discount,
        n_steps=n_steps,
        trace_decay=trace_decay,
        first_visit=first_visit,
        weighted=weighted,
        initial_value=initial_value,
        on_truncation=cast("Any", on_truncation),
        bit_generator=cast("Any", bit_generator),
    )
    limit = memory_limit(None)
    numbers = seed_sequence(seeds, limit)
    points = recorded_episodes(record, settings.episodes)
    given: dict[str, Any] = {} if max_episode_steps is None else {"max_episode_steps": max_episode_steps}
    if env_kwargs is not None:
        given["env_kwargs"] = env_kwargs
    resolved, space = resolve_prediction(env, policy, settings, numbers[0], given)
    log_default_limit(resolved)
    log_python_stepping(resolved)
    estimates, failed = run_prediction(
        resolved, space, settings, policy, behavior, features, numbers, points, thread_count(threads), limit
    )
    for index, error in failed:
        if hasattr(error, "add_note"):
            error.add_note(f"in the run with seed {numbers[index]}")
        raise error
    return estimates


def resolve_prediction(
    env: Any, policy: GivenPolicy, settings: PredictionSettings, seed: int, given: Mapping[str, Any]
) -> tuple[ResolvedRun, gym.Space[Any] | None]:
    """Returns the task of a prediction as a run, and its observation space where a function needs it."""
    of_run = {name: getattr(policy.config, name) for name in _DISCRETIZER} if isinstance(policy, Run) else {}
    made = env
    if not isinstance(env, gym.Env | str | EnvSpec):
        if not callable(env):
            raise TypeError(
                f"env must be an environment id, an EnvSpec, an environment or a function, got {shown(env)}"
            )
        made = env()
        if not isinstance(made, gym.Env):
            raise TypeError(f"env must make an environment, got {shown(made)}")
    resolved = resolve(made, {**settings.config(), **of_run, **given, "seed": seed}, owns_env=made is not env)
    if not resolved.discretizer.has_cells or resolved.discretizer.reads_space:
        raise ValueError(f"env must have observations with a cell each, got {resolved.discretizer!r}")
    if isinstance(made, gym.Env) or not callable(policy):
        return resolved, made.observation_space if isinstance(made, gym.Env) else None
    # A function of the observation has to see observations of the right type.
    with closing(gym.make(made, **dict(given.get("env_kwargs", {})))) as again:
        return resolved, again.observation_space


def run_prediction(
    resolved: ResolvedRun,
    space: gym.Space[Any] | None,
    settings: PredictionSettings,
    policy: GivenPolicy,
    behavior: GivenPolicy | None,
    features: ArrayLike | None,
    seeds: Sequence[int],
    points: NDArray[np.uint64],
    threads: int,
    limit: int,
) -> tuple[ValueEstimates, list[tuple[int, Exception]]]:
    """Runs a prediction; returns the estimates and the runs that failed, whose missing weights are NaN."""
    cells, actions = resolved.discretizer, resolved.actions
    target = probabilities("policy", policy, space, cells, actions)
    followed = _behavior(
        behavior, target, settings, lambda given: probabilities("behavior", given, space, cells, actions)
    )
    rows, n_weights = feature_rows(features, cells.n_rows)
    n_active = rows.shape[1]
    if settings.method in AVERAGES_ONLY and n_active > 1:
        raise ValueError(f"features must have one active row for method {settings.method!r}, got {n_active}")
    if n_active == 1 and settings.learning_rate is not None and settings.learning_rate > 1.0:
        raise ValueError(f"learning_rate must lie in [0, 1] for a table, got {shown(settings.learning_rate)}")
    if not resolved.is_native and len(seeds) > 1:
        raise ValueError(f"seeds must be one seed for an environment that is stepped in Python, got {len(seeds)}")
    size = len(seeds) * len(points) * n_weights * 8
    check_memory(f"{len(seeds)} runs with {len(points)} recorded episodes (record= keeps fewer)", size, limit)
    weights = np.full((len(seeds), len(points), n_weights), np.nan)
    began = time.perf_counter()
    spec: Any = {**resolved.spec(), "learning_rate": schedule_of(vars(settings)).spec()}
    initial = np.full(n_weights, settings.initial_value / n_active)
    prediction: Any = {
        "method": settings.method_spec(),
        "target": target,
        "behavior": followed,
        "rows": rows,
        "initial_weights": initial,
    }
    with resolved.environment.exclusively():
        failed = _core.estimate_values(spec, prediction, seeds, points, weights, threads)
    shape = cells.shape
    return ValueEstimates(
        env=resolved.config.env,
        settings=settings,
        seeds=tuple(seeds),
        episodes=points.astype(np.int64),
        weights=weights,
        rows=rows,
        probabilities=target.reshape(*shape, len(actions)),
        behavior=followed.reshape(*shape, len(actions)),
        config=resolved.config,
        seconds=time.perf_counter() - began,
    ), failed


def _behavior(
    behavior: GivenPolicy | None,
    target: NDArray[np.float64],
    settings: PredictionSettings,
    table: Callable[[GivenPolicy], NDArray[np.float64]],
) -> NDArray[np.float64]:
    """The policy that chooses the actions: the one that is evaluated, except off policy."""
    off_policy = settings.method == "importance_sampling"
    if behavior is None:
        if off_policy:
            raise ValueError("behavior must be given for method 'importance_sampling', got None")
        return target
    if not off_policy:
        raise ValueError(
            f"behavior applies to method 'importance_sampling', not to {settings.method!r}, got {shown(behavior)}"
        )
    followed = table(behavior)
    missing = np.argwhere((target > 0.0) & (followed == 0.0))
    if len(missing):
        row, action = missing[0]
        raise ValueError(
            f"behavior must cover policy: it never takes action {action} in row {row}, which policy takes with "
            f"probability {target[row, action]:g}"
        )
    return followed


def recorded_episodes(record: Any, episodes: int) -> NDArray[np.uint64]:
    """Returns (points,) uint64: after how many episodes the weights are kept, ascending; always after the last.

    Raises:
        TypeError: if ``record`` is not an integer or a sequence of integers.
        ValueError: if a number is out of range.
    """
    if record is None:
        record = 1
    if not checks.is_sequence(record):
        every = checks.count("record", record, least=1)
        count = math.ceil(episodes / every)
        check_memory(f"{count} recorded episodes (record= keeps fewer)", 8 * count, memory_limit(None))
        points = np.arange(1, count + 1, dtype=np.uint64) * np.uint64(every)
        points[-1] = episodes
        return points
    numbers = sorted({checks.integer("record", number, least=0, most=episodes) for number in record} | {episodes})
    return np.array(numbers, dtype=np.uint64)
