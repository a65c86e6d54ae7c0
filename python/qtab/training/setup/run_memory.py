"""Computes the memory that runs take before they start."""

import math

from qtab._utils.memory import BYTES_PER_EPISODE, check_memory, memory_left
from qtab._utils.shown import counted, shown
from qtab.config.options import n_tables
from qtab.results.run import Run
from qtab.training.callbacks import TrainingOptions
from qtab.training.setup.environment import NativeEnvironment, PythonEnvironment, mask_bytes
from qtab.training.setup.resolved_run import ResolvedRun

BYTES_PER_VALUE = {
    "sarsa_lambda": 24,
    "true_online_sarsa_lambda": 24,
    "watkins_q_lambda": 24,
    "dyna_q": 36,
    "dyna_q_plus": 44,
    "monte_carlo": 4,
    "monte_carlo_es": 4,
    "off_policy_monte_carlo": 8,
    "prioritized_sweeping": 64,
    "gradient_bandit": 16,
    "actor_critic_lambda": 16,
}
"""Additional bytes per table value by algorithm: traces, or the model's outcome of each state-action pair."""
BYTES_PER_VISIT_COUNT = 4
BYTES_PER_RECORDING = 512
"""The approximate size of a recorded episode without its actions: the state of a generator as Python objects."""
RESTORED = 3
"""The approximate memory that restoring the state of a run takes, as a multiple of its size."""


def tables_shape(resolved: ResolvedRun, runs: int) -> tuple[int, int, int, int]:
    """Returns the shape of the Q tables of ``runs`` runs: (runs, k, rows, actions)."""
    return runs, n_tables(resolved.config.algorithm), resolved.discretizer.n_rows, len(resolved.actions)


def bytes_in_progress(resolved: ResolvedRun) -> int:
    """Returns the memory of a run while it trains, in bytes: without an environment in Python."""
    values = math.prod(tables_shape(resolved, 1))
    per_value = 8 + BYTES_PER_VALUE.get(resolved.config.algorithm, 0)
    if resolved.config.learning_rate_schedule == "visits":
        per_value += BYTES_PER_VISIT_COUNT
    if resolved.config.exploration == "ucb":
        per_value += BYTES_PER_VISIT_COUNT
    masks = 0 if resolved.masks is None else mask_bytes(resolved.discretizer, len(resolved.actions))
    external = resolved.environment.external if isinstance(resolved.environment, NativeEnvironment) else None
    states = 0 if external is None else 2 * external.state_size  # that before a step and that after it
    return resolved.config.episodes * BYTES_PER_EPISODE + values * per_value + masks + states


def bytes_of_run(resolved: ResolvedRun) -> int:
    """Returns the memory of a run until its episodes are copied from the trainer's lists to arrays, in bytes."""
    return bytes_in_progress(resolved) + resolved.config.episodes * BYTES_PER_EPISODE


def table_words(resolved: ResolvedRun, needed: int) -> tuple[str, str]:
    """Returns two parts of a message about too little memory: the table, if it outweighs the episodes, and a remedy.

    Args:
        resolved: The run.
        needed: The number of bytes needed.
    """
    if 2 * resolved.config.episodes * (BYTES_PER_EPISODE + BYTES_PER_RECORDING) > needed:
        return "", ""
    *_, rows, actions = tables_shape(resolved, 1)
    environment = resolved.environment
    space = f" for {shown(environment.env.observation_space)}" if isinstance(environment, PythonEnvironment) else ""
    no_cells = resolved.config.max_rows is not None or not resolved.discretizer.has_cells
    instead = "" if no_cells else "; max_rows= assigns rows only to the observations that are seen"
    return f" with a table of {counted(rows, 'row')} of {counted(actions, 'action')}{space}", instead


def check_run_memory(
    resolved: ResolvedRun, options: TrainingOptions, snapshots: int, earlier: Run | None = None
) -> tuple[int, int]:
    """Checks that a run fits into the memory limit.

    Args:
        resolved: The run.
        options: The limit, recordings and visits of the call.
        snapshots: The number of copies of the tables that the run keeps.
        earlier: The earlier run that it continues, if any.

    Returns:
        The limit in bytes, and the bytes left for data that grows during the run: recordings, and the episode or
        model that its algorithm stores.

    Raises:
        MemoryError: if the run does not fit.
    """
    episodes = resolved.config.episodes
    copies = 8 * math.prod(tables_shape(resolved, 1 + snapshots + 2 * bool(options.visits)))
    recordings = min(int(options.record), episodes)
    state = 0 if earlier is None or earlier.state is None else RESTORED * len(earlier.state.checkpoint)
    needed = bytes_in_progress(resolved) + copies + recordings * BYTES_PER_RECORDING + state
    extras = [counted(number, noun) for number, noun in ((recordings, "recording"), (snapshots, "snapshot")) if number]
    what = counted(episodes, "episode") + (f" with {' and '.join(extras)}" if extras else "")
    table, instead = table_words(resolved, needed)
    check_memory(what + table, needed, options.memory_limit, instead)
    return memory_left(needed, options.memory_limit)
