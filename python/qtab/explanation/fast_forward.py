"""The start of a later episode, from Rust: the tables and generators that the reference would have at that point.

Rust trains up to the episode, which gives the tables and the environment's generator. The agent's generator skips the
numbers that the policy drew, without taking steps, if their count depends neither on values nor on a model.
"""

from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab.config.choices import IN_PYTHON
from qtab.config.options import AVERAGE_REWARD, PREFERENCES, TABLES_ONLY, WITH_STATE_VALUES, n_tables
from qtab.reference.parts.schedules import epsilon_schedule
from qtab.reference.parts.streams import AgentStream, agent_stream
from qtab.results.recording import generator_before
from qtab.results.run import Run
from qtab.training.setup.run_env import resolve_run

CHOOSE_FIRST = ("q_learning", "expected_sarsa", "double_q_learning", *PREFERENCES)
"""The algorithms that choose an action before each step; the others choose the next one after it."""


@dataclass(frozen=True)
class Start:
    """The start of an episode, and its end to compare with."""

    episode: int
    tables: NDArray[np.float64]
    """(k, rows, actions): the tables before the episode."""
    tables_after: NDArray[np.float64]
    """(k, rows, actions): the tables after it."""
    env_generator: Any
    """The state of the environment's bit generator before its reset."""
    columns: tuple[int, ...]
    """The columns of the actions of the episode."""
    stream: AgentStream
    """The agent's random numbers from the episode on."""


def start_of(run: Run, episode: int) -> Start | None:
    """Returns the start of an episode; None if the agent's random numbers or counts depend on the steps before it."""
    config = run.config
    by_values = (
        config.ties == "random"
        or config.exploration == "ucb"
        or config.action_mask is not False
        or (isinstance(config.initial_q, np.ndarray) and np.isneginf(config.initial_q).any())
    )
    if config.backend in IN_PYTHON or config.algorithm in (*TABLES_ONLY, *AVERAGE_REWARD) or by_values:
        return None
    if episode == 0 or config.learning_rate_schedule == "visits":
        return None
    resolved = resolve_run(config, {name: value for name, value in vars(config).items() if name != "env"})
    with closing(resolved):
        trainer = _core.Trainer(resolved.spec(), resolved.seed, record=1)
        trainer.advance(episode)
        before = trainer.tables()
        trainer.advance(episode + 1)
        start, columns = trainer.take_recordings()[-1]
        env_generator = generator_before(resolved.config.seed, start)
    shape = run.tables.shape
    return Start(
        episode,
        before.reshape(shape),
        trainer.tables().reshape(shape),
        env_generator,
        tuple(columns),
        _agent_stream(run, episode),
    )


def _agent_stream(run: Run, episode: int) -> AgentStream:
    """Returns the agent's random numbers after ``episode`` episodes, without those that tables and policy drew."""
    config, n_actions = run.config, len(run.actions)
    stream = agent_stream(config.seed or 0, config.bit_generator)
    if isinstance(config.initial_q, tuple):
        # State values are 0 at first, not drawn.
        for _ in range(1 if config.algorithm in WITH_STATE_VALUES else n_tables(config.algorithm)):
            stream.uniform(*config.initial_q, size=run.tables.shape[1:])
    epsilon = None if config.exploration == "softmax" else epsilon_schedule(config)
    lengths, terminated = run.episode_lengths.tolist(), run.terminated.tolist()
    draw, has_coin = stream.random, config.algorithm == "double_q_learning"
    for number in range(episode):
        choices = lengths[number]
        if config.algorithm not in CHOOSE_FIRST:
            is_terminal = terminated[number] or config.on_truncation == "terminate"
            choices += 0 if is_terminal else 1
        greedy_below = 1.0 if epsilon is None else 1.0 - epsilon.value
        for _ in range(choices):
            if not draw() < greedy_below:
                stream.integers(0, n_actions)
            if has_coin:
                draw()
        if epsilon is not None:
            epsilon.end_episode()
    return stream
