"""``qtab.estimate_values``: estimates the values of a given policy from episodes, with many seeds at once."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec
from numpy.typing import ArrayLike

from qtab._utils.progress import check_progress
from qtab.config.choices import Backend, DiscretizerName, LearningRateSchedule
from qtab.config.unknown import suggesting
from qtab.planning.least_squares.lstdq import GivenFeatures
from qtab.planning.policies import GivenPolicy
from qtab.prediction.estimates import ValueEstimates
from qtab.prediction.learning_rates import LEAST_SQUARES
from qtab.prediction.runs import recorded_episodes, run_prediction
from qtab.prediction.settings import Method, PredictionSettings
from qtab.prediction.task import OF_OBSERVATIONS, resolve_prediction
from qtab.training.setup.resolved_run import log_default_limit, log_python_stepping
from qtab.training.train_many import seed_sequence, thread_count

if TYPE_CHECKING:
    from qtab.config.settings import Array, Integer, Integers, Real, Reals


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
    second_learning_rate: float | None = None,
    discount: float = 1.0,
    n_steps: int | None = None,
    trace_decay: float | None = None,
    first_visit: bool | None = None,
    weighted: bool | None = None,
    epsilon: float | None = None,
    recursive: bool | None = None,
    behavior: GivenPolicy | None = None,
    discretizer: DiscretizerName | None = None,
    tilings: "Integer | None" = None,
    tiles: "Integer | Integers | None" = None,
    hashed_rows: "Integer | None" = None,
    bins: "Integer | Integers | None" = None,
    edges: "Sequence[Reals] | None" = None,
    scale: "Reals | None" = None,
    low: "Reals | None" = None,
    high: "Reals | None" = None,
    order: "Integer | None" = None,
    coupled: bool | None = None,
    scale_step_sizes: bool | None = None,
    centers: "Integer | Integers | None" = None,
    width: "Real | Reals | None" = None,
    normalized: bool | None = None,
    radius: "Real | Reals | None" = None,
    actions: "Integer | Sequence[Real | Reals] | Array | None" = None,
    features: GivenFeatures | None = None,
    initial_value: float = 0.0,
    initial_weights: ArrayLike | None = None,
    on_truncation: str = "bootstrap",
    bit_generator: str = "PCG64",
    seeds: int | Iterable[int] = 1,
    record: int | Sequence[int] | None = None,
    max_episode_steps: int | None = None,
    backend: Backend = "auto",
    env_kwargs: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: bool | None = None,
    memory_limit: int | None = None,
) -> ValueEstimates:
    """Estimates the values of a policy from episodes that follow it. This is prediction; :func:`qtab.train` is control.

    Environments in Rust run on threads, with any number of seeds, unless the policy is a function of the observations
    of a Box. An environment stepped in Python takes a single seed.

    Args:
        env: An environment's id, its EnvSpec, an environment, or a function that makes one. Its observations are
            discrete, or a Box with one axis of floats, which a discretizer divides.
        policy: ``"random"`` for equal probabilities; an array (*cells,) of actions or (*cells, actions) of
            probabilities; a function from an observation to an action's number or to (actions,) probabilities; a run,
            for its greedy policy, with preferences the most likely action; or an optimum that does not depend on the
            steps left. Functions, and runs on a Box with other cells or a function of action masks, choose by
            the observation, not by its cell.
        method: ``"td"`` is TD(0) (Sutton & Barto, 2nd ed., eq. 6.2), ``"n_step_td"`` eq. 7.2, ``"td_lambda"`` and
            ``"true_online_td_lambda"`` the boxes in sections 12.2 and 12.5, ``"offline_lambda_return"`` eq. 12.4,
            ``"monte_carlo"`` eq. 6.1 and the box in section 5.1, ``"importance_sampling"`` eqs. 5.5 and 5.6,
            ``"batch_td"`` section 6.3. Batch Monte Carlo is ``"monte_carlo"`` without a learning rate. Off policy,
            ``"off_policy_td"`` is semi-gradient TD(0) (eq. 11.2), ``"off_policy_td_lambda"`` eqs. 12.23 to 12.25,
            ``"gtd2"`` and ``"tdc"`` section 11.7, ``"emphatic_td"`` section 11.8 with an interest of 1 in every state.
            ``"lstd"`` is LSTD(λ) (section 9.8), as :class:`qtab.prediction.LSTD`.
        episodes: The number of episodes.
        learning_rate: α, in [0, 2]: the fraction of the error that an update corrects, divided among the active
            features, unless they have values other than 1. None means 1 / n at the n-th visit of a feature, so that
            Monte Carlo values are averages of returns.
        learning_rate_schedule: ``"linear"`` or ``"exponential"`` over the episodes, ``"constant"``, or ``"visits"``:
            learning_rate / n at the n-th visit of a feature, for methods without traces. None means ``"visits"``
            without a learning rate, ``"linear"`` with a ``min_learning_rate`` or a ``learning_rate_warm_up``, otherwise
            ``"constant"``.
        min_learning_rate: The lowest learning rate of a schedule, in [0, learning_rate]; None means 0.
        learning_rate_decay: The factor of ``"exponential"`` after each episode, in [0, 1]; None means 0.999.
        learning_rate_warm_up: The number of episodes before ``"linear"`` or ``"exponential"`` begins; None means 0.
        second_learning_rate: β, in [0, 2]: the step size of the second weight vector of ``"gtd2"`` and ``"tdc"``, which
            is zero at first. It is constant, and divided like α.
        discount: γ, in [0, 1].
        n_steps: n, at least 1: the number of rewards in a target of ``"n_step_td"``.
        trace_decay: λ, in [0, 1]: the decay of traces and of λ-returns. For ``"lstd"``, None means 0.
        first_visit: Whether only the first visit of a state in an episode counts, for ``"monte_carlo"`` and
            ``"importance_sampling"``; None means every visit.
        weighted: Whether importance sampling is weighted or ordinary; None means weighted.
        epsilon: ε, above 0: the matrix A of ``"lstd"`` begins as ε times the identity; None means 0.001.
        recursive: Whether ``"lstd"`` updates A⁻¹ at each step, with at most 4,096 weights, or solves the equations
            after each episode, with at most 1,024; None means True.
        behavior: The policy that chooses the actions, for the off-policy methods, in the same forms as ``policy``. It
            must be able to take every action that ``policy`` can take. For ``"gtd2"``, ``"tdc"`` and
            ``"emphatic_td"``, None means ``policy`` itself.
        discretizer: The discretizer of a Box of observations, as in :func:`qtab.train`: cells by ``"round"``,
            ``"bins"`` or ``"edges"``, ``"tiles"``, or features with values other than 1 by ``"fourier"``,
            ``"polynomial"``, ``"radial"`` or ``"coarse"``. None uses that of a run as the policy, or else the
            environment's default.
        tilings: For ``"tiles"``: the number of tilings; None means 8.
        tiles: For ``"tiles"``: the number of tiles along each component, or one for all; None means 8.
        hashed_rows: For ``"tiles"``: the number of weights that the tiles share by hashing; None gives each tile a
            weight.
        bins: For ``"bins"``: the number of bins along each component, or one for all; None means 10.
        edges: For ``"edges"``: the inner edges of the cells along each component.
        scale: For ``"round"``: the number of cells per unit of each component.
        low: The lower limit of each component, except for ``"round"`` and ``"edges"``; None uses that of the space.
        high: The upper limit of each component, like ``low``.
        order: For ``"fourier"`` and ``"polynomial"``: the largest frequency or exponent of a component; None means 3.
        coupled: For ``"fourier"`` and ``"polynomial"``: whether there is a feature for each combination of frequencies
            or exponents; None means True.
        scale_step_sizes: For ``"fourier"``: whether the step sizes of a feature are divided by the length of its
            frequency vector; None means True, and False for ``"lstd"``, which has no step size.
        centers: For ``"radial"`` and ``"coarse"``: the number of centers along each component, or one for all, at least
            2; None means 5.
        width: For ``"radial"``: σ along each component, or one for all, in distances between neighboring centers; None
            means 1.
        normalized: For ``"radial"``: whether the features are divided by their sum; None means False.
        radius: For ``"coarse"``: the radius of the receptive fields along each component, or one for all, in distances
            between neighboring centers; None means 1.5.
        actions: For a Box of actions: the actions to choose from, or the number of values of each component.
        features: None for a table; or (states,) or (states, n_active) integers: the features that are active in each
            state, as :func:`qtab.prediction.state_aggregation` and :func:`qtab.prediction.tile_coding` return them; or
            (states, d) or (*cells, d) floats: the feature vector of each state; or, for discrete observations, a
            function from an observation to its feature vector, (d,) numbers. Integers that a function returns are the
            numbers of a vector, too, not active features as in an array.
        initial_value: The value of every state before the first episode, 0 for features with values other than 1.
        initial_weights: (n_weights,): the weights before the first episode, instead of ``initial_value``.
        on_truncation: The end of a return at the time limit: it continues with the value of the last state
            (``"bootstrap"``), or ends there (``"terminate"``).
        bit_generator: The random generator of the policy, ``"PCG64"`` or ``"MT19937"``.
        seeds: The seeds of the runs; an integer N means 0 to N - 1.
        record: The numbers of episodes after which the weights are kept: an integer n means every n episodes; a
            sequence lists the numbers, with 0 for the initial weights; None means after every episode.
        max_episode_steps: The time limit in steps; None means the environment's own limit, or 10,000.
        backend: What steps the environment, as in :func:`qtab.train`: ``"numba"`` compiles an ordinary Gymnasium class.
        env_kwargs: Keyword arguments of the environment's constructor, with an id or a spec.
        threads: The number of threads; None means one per core. It does not change the results.
        progress: Whether to show a progress bar. None shows one on a terminal or in a notebook if the episodes take
            more than a second and tqdm is installed.
        memory_limit: The number of bytes that the estimates may take; None means half of the machine's memory, but no
            more than is free.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        MemoryError: if the recorded weights would take more than ``memory_limit``, or the steps that a method stores
            exceed it.
        OverflowError: if the values of a run overflow, because ``learning_rate`` or ``trace_decay`` is too large, or
            the method is not stable off policy.
        ModuleNotFoundError: if ``progress`` is True and tqdm is not installed.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range or that does not apply to the method, a policy of the wrong shape or
            with probabilities that do not sum to 1, or a ``behavior`` that does not cover it.
        KeyboardInterrupt: on Ctrl-C.
    """
    arguments = locals()
    settings = PredictionSettings(**{field.name: arguments[field.name] for field in fields(PredictionSettings)})
    of_task = (*OF_OBSERVATIONS, "max_episode_steps", "backend", "env_kwargs")
    given = {name: arguments[name] for name in of_task if arguments[name] is not None}
    check_progress(progress)
    numbers = seed_sequence(seeds, memory_limit)
    points = recorded_episodes(record, settings.episodes, memory_limit)
    resolved, space = resolve_prediction(env, policy, settings, numbers[0], given, reads_space=callable(features))
    log_default_limit(resolved)
    log_python_stepping(resolved)
    estimates, failed = run_prediction(
        resolved,
        space,
        settings,
        policy,
        behavior,
        features,
        numbers,
        points,
        thread_count(threads),
        memory_limit,
        progress,
        initial_weights,
    )
    for index, error in failed:
        if hasattr(error, "add_note"):
            error.add_note(f"in the run with seed {numbers[index]}")
            if settings.method == LEAST_SQUARES and isinstance(error, OverflowError):
                error.add_note("A is singular, or its numbers overflowed: another epsilon helps")
        raise error
    return estimates
