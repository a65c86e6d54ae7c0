"""The action values of a run, also of its initial tables, and the policy that follows from them.

Actions that an observation excludes have a value of -inf.
"""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import shown
from qtab.config import Config
from qtab.config.functions import FORGOTTEN, checked_mask
from qtab.config.options import PREFERENCES, WITH_STATE_VALUES
from qtab.config.schedules import EpsilonGreedy, Ucb, policy
from qtab.results.time_steps import rows_of

if TYPE_CHECKING:
    from qtab.results.run import Run


def summed(parts: Iterable[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Adds from left to right, as the learners do; ``np.sum`` would add in pairs."""
    first, *others = parts
    total: NDArray[np.float64] = np.array(first)
    for part in others:
        total += part
    return total


def weighted_sum(x: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns (..., actions): the sums of the products of (..., n) features and (n, actions) weights.

    Four partial sums are added in pairs, as the learners do.
    """
    parts = np.zeros((4, *x.shape[:-1], weights.shape[-1]))
    for index, row in enumerate(weights):
        parts[index % 4] += x[..., index, np.newaxis] * row
    return np.asarray((parts[0] + parts[1]) + (parts[2] + parts[3]))


def read_by_policy(config: Config, tables: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the tables, (k, ...), whose sum the greedy policy uses; preferences without the state values."""
    return tables[:1] if config.algorithm in WITH_STATE_VALUES else tables


def masked_tables(run: "Run") -> NDArray[np.float64]:
    """Returns (k, rows, actions): the tables that the greedy policy adds, with -inf where a mask excludes an action."""
    tables = read_by_policy(run.config, run.tables)
    return tables if run.action_masks is None else np.where(run.action_masks.reshape(tables.shape[1:]), tables, -np.inf)


def greedy_table(run: "Run") -> NDArray[np.float64]:
    """Returns (1, rows, actions): the table that the greedy policy uses; with two tables their sum."""
    return summed(read_by_policy(run.config, run.tables))[np.newaxis]


def state_values(run: "Run", observation: Any, steps: Any = 0) -> NDArray[np.float64]:
    """Returns the () or (n,) values of observations under the learned policy.

    Raises:
        ValueError: for an algorithm that learns only preferences.
    """
    if run.config.algorithm in WITH_STATE_VALUES:
        rows = rows_of(run, observation, steps)
        if run.discretizer.is_weighted:
            return np.asarray(weighted_sum(rows, run.tables[1][:, :1])[..., 0])
        return summed(run.tables[1][row, 0] for row in np.moveaxis(rows, -1, 0))
    if run.config.algorithm in PREFERENCES:
        raise ValueError(
            f"values needs an algorithm that learns values, got a run of {run.config.algorithm!r}, which learns "
            "only preferences: run.q_values(observation) returns them"
        )
    return np.asarray(np.max(of_observations(run, observation, steps), axis=-1) / len(run.tables))


def of_cells(run: "Run") -> NDArray[np.float64]:
    """Returns (*cells, actions): the values or preferences that the greedy policy uses; with two tables their sum."""
    values = summed(read_by_policy(run.config, run.tables)).reshape(*run.discretizer.shape, len(run.actions))
    return values if run.action_masks is None else np.where(run.action_masks, values, -np.inf)


def of_observations(run: "Run", observation: Any, steps: Any = 0) -> NDArray[np.float64]:
    """Returns the (actions,) or (n, actions) values of one or n observations after ``steps`` steps."""
    rows = rows_of(run, observation, steps)
    values = _of_rows(run, rows)
    available = _available(run, observation, rows)
    return values if available is None else np.where(available, values, -np.inf)


def to_choose_from(run: "Run", observation: Any, action_masks: Any, steps: Any = 0) -> NDArray[np.float64]:
    """Returns the values by which to choose the actions of observations, masked by ``action_masks`` if given.

    Raises:
        TypeError: if the masks do not hold booleans or integers.
        ValueError: if the masks do not fit, or none are given and none are known.
    """
    rows = rows_of(run, observation, steps)
    values = _of_rows(run, rows)
    if action_masks is not None:
        given = np.asarray(action_masks)
        masks = [checked_mask("action_masks", mask, values.shape[-1]) for mask in np.atleast_2d(given)]
        if len(masks) != len(np.atleast_2d(values)) or given.ndim > values.ndim:
            raise ValueError(f"action_masks must have shape {values.shape}, an item for each action, got {given.shape}")
        masked = np.where(np.reshape(masks, values.shape), values, -np.inf)
        if np.isneginf(masked).all(axis=-1).any():
            raise ValueError(
                f"action_masks must allow an action that is not -inf in the run's initial_q, got {shown(action_masks)}"
            )
        return masked
    available = _available(run, observation, rows)
    if available is not None:
        return np.where(available, values, -np.inf)
    if run.config.action_mask is True:
        raise ValueError(
            "action_masks must be given: the run was trained with the masks of its environment, and has no cells "
            "whose masks it could keep"
        )
    if isinstance(run.config.action_mask, str):
        raise ValueError(FORGOTTEN)
    return values


def _of_rows(run: "Run", rows: NDArray[Any]) -> NDArray[np.float64]:
    tables = read_by_policy(run.config, run.tables)
    if run.discretizer.is_weighted:
        return summed(weighted_sum(rows, table) for table in tables)
    active = np.moveaxis(rows, -1, 0)
    return summed(summed(table[row] for row in active) for table in tables)


def _available(run: "Run", observation: Any, rows: NDArray[Any]) -> NDArray[np.bool_] | None:
    """Returns (..., actions): the masks of observations, from the function or as last seen in their cells."""
    setting = run.config.action_mask
    if callable(setting):
        observations = run.discretizer.split(observation, None if rows.ndim == 1 else len(rows))
        masks = [checked_mask("action_mask", setting(one), len(run.actions)) for one in observations]
        return np.array(masks, np.bool_).reshape(*rows.shape[:-1], len(run.actions))
    if run.action_masks is None:
        return None
    known: NDArray[np.bool_] = run.action_masks.reshape(-1, len(run.actions))
    masks_of: NDArray[np.bool_] = known[rows[..., 0]]
    return masks_of


def mask_of_step(config: Config, env: gym.Env, observation: Any, info: Mapping[str, Any]) -> NDArray[np.bool_] | None:
    """Returns the mask of the last result of an environment's ``reset`` or ``step``; None without masks.

    Raises:
        TypeError: if the mask does not hold booleans or integers.
        ValueError: if the mask does not fit or is missing, or its function is not known.
    """
    setting = config.action_mask
    if setting is False:
        return None
    if isinstance(setting, str):
        raise ValueError(FORGOTTEN)
    if callable(setting):
        name, given = "action_mask", setting(observation)
    elif env.has_wrapper_attr("action_masks"):
        name, given = "action_masks()", env.get_wrapper_attr("action_masks")()
    elif "action_mask" in info:
        name, given = "info['action_mask']", info["action_mask"]
    else:
        raise ValueError("info must have an 'action_mask', as in the run's training")
    return checked_mask(name, given, np.size(given))


def initial_tables(run: "Run") -> NDArray[np.float64]:
    """Returns (k, rows, actions): the tables before the first episode."""
    initial, shape = run.config.initial_q, run.tables.shape
    if isinstance(initial, tuple):
        from qtab.reference.parts.streams import agent_stream

        stream = agent_stream(run.config.seed or 0, run.config.bit_generator)
        return np.stack([stream.uniform(*initial, size=shape[1:]) for _ in range(shape[0])])
    return np.broadcast_to(np.asarray(initial, dtype=np.float64).reshape(-1), (int(np.prod(shape)),)).reshape(shape)


def are_finite(run: "Run") -> bool:
    """Returns whether all values are finite, except for excluded actions, which are -inf from the start."""
    finite = np.isfinite(run.tables)
    return bool(finite.all() or (finite | np.isneginf(initial_tables(run))).all())


def action_probabilities(config: Config, episodes: int, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns (n, actions): the probability of each action after ``episodes`` episodes.

    Args:
        config: The config of a run.
        episodes: The number of finished episodes, which determines ε.
        values: (n, actions): the action values, -inf for unavailable actions; each row has an available action.
    """
    chosen = policy(config)
    if isinstance(chosen, EpsilonGreedy):
        epsilon = chosen.epsilon.after(episodes, config.episodes)
        greedy = _greedy(values, chosen.ties == "random")
        return epsilon * _uniform(~np.isneginf(values)) + (1.0 - epsilon) * _uniform(greedy)
    if isinstance(chosen, Ucb):  # a run does not hold the action counts that UCB needs
        return _uniform(_greedy(values, chosen.ties == "random"))
    with np.errstate(under="ignore"):
        weights = np.exp((values - values.max(axis=1, keepdims=True)) / chosen.temperature)
    probabilities: NDArray[np.float64] = weights / weights.sum(axis=1, keepdims=True)
    return probabilities


def sample(probabilities: NDArray[np.float64], generator: np.random.Generator) -> NDArray[np.int64]:
    """Returns (n,): an action drawn from each row of (n, actions) probabilities."""
    cumulative = np.cumsum(probabilities, axis=1)
    total = cumulative[:, -1:]
    # After rounding, a draw may equal the total; the last actions may have probability 0.
    drawn = np.minimum(generator.random(total.shape) * total, np.nextafter(total, 0.0))
    actions: NDArray[np.int64] = np.argmax(drawn < cumulative, axis=1)
    return actions


def _greedy(values: NDArray[np.float64], all_of_them: bool) -> NDArray[np.bool_]:
    greedy: NDArray[np.bool_] = values == values.max(axis=1, keepdims=True)
    if not all_of_them:
        greedy = np.arange(values.shape[1]) == np.argmax(values, axis=1)[:, np.newaxis]
    return greedy


def _uniform(chosen: NDArray[np.bool_]) -> NDArray[np.float64]:
    shares: NDArray[np.float64] = chosen / chosen.sum(axis=1, keepdims=True)
    return shares
