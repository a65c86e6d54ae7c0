"""``qtab.explain``: the steps of an episode, repeated by the reference learner, with the numbers of every update."""

import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.progress import ProgressBar
from qtab.config import Config
from qtab.config.options import AVERAGE_REWARD, MONTE_CARLO
from qtab.explanation.explanation import Explanation
from qtab.explanation.fast_forward import Start, start_of
from qtab.explanation.records import ExplainedStep, Trace, Update
from qtab.explanation.watcher import SeenStep, Watcher
from qtab.plots.arrangements.grid_map import Layout, checked_layout
from qtab.reference import LEARNERS
from qtab.reference.parts.observer import observed_by
from qtab.reference.parts.schedules import LearningRate
from qtab.results.rates import ONLY_FIRST, repeatable
from qtab.results.run import Run
from qtab.results.run_state import restored_generator
from qtab.results.time_steps import rows_of
from qtab.results.words import Names, checked_action_names, numbered_states
from qtab.training.setup.run_env import check_same, make_run_env

Record = TypeVar("Record", Update, Trace)

N_STEP = ("n_step_sarsa", "n_step_tree_backup", "n_step_q_sigma")
"""The algorithms whose updates wait for n steps."""


def explain(
    run: Run,
    episode: int = 0,
    steps: int = 5,
    start: int = 0,
    env: gym.Env | None = None,
    *,
    layout: Layout | None = None,
    action_names: Sequence[str] | None = None,
    progress: bool | None = None,
) -> Explanation:
    """Explains steps of an episode: the observation, the reason for the action, and the update from the result.

    The reference learner in plain NumPy repeats the episode, with the same numbers to the last bit. Rust trains up to
    its start, and the agent's random numbers are skipped up to that point; values and actions are compared with Rust's.
    If random numbers or counts depend on the earlier steps (ties broken at random, missing actions, a learning rate by
    visits, methods with a model, Monte Carlo and differential methods, environments in Python), the reference also
    repeats all earlier episodes, which takes tens of microseconds per step, or hundreds with traces over many tiles.

    Args:
        run: The run.
        episode: The number of the episode, from 0.
        steps: The number of steps to explain; fewer if the episode ends before.
        start: The first of these steps, from 0.
        env: The environment, if that of the run cannot be made again. It must be the environment of the training.
        layout: The map of an environment with numbered states, as for :func:`qtab.plots.values`, which names them by
            their row and column. None takes the known one, or the environment's attribute ``layout`` or ``shape``.
        action_names: A name for each action, as for :func:`qtab.plots.policy`. None takes the environment's attribute
            ``action_names``, or else ``run.action_names``.
        progress: Whether to show a progress bar. None shows one on a terminal if it takes more than a second.

    Raises:
        RuntimeError: if the reference does not repeat the run's episodes, so that nothing can be explained.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range. If a run was resumed with more episodes while a rate fell, only the
            episodes before can be explained.
    """
    checks.instance("run", run, Run)
    finished = len(run.episode_returns)
    if finished == 0:
        raise ValueError("run must have a finished episode, got one that was stopped during its first")
    episode = checks.integer("episode", episode, least=0, most=finished - 1)
    run, most = repeatable(run)
    if episode >= most:
        raise ValueError(
            f"episode must be at most {most - 1:,} for a run that was extended after {most:,} episodes: {ONLY_FIRST}, "
            f"got {episode}"
        )
    start = checks.integer("start", start, least=0, most=int(run.episode_lengths[episode]) - 1)
    steps = checks.integer("steps", steps, least=1)
    if env is not None and not isinstance(env, gym.Env):
        raise TypeError(f"env must be an environment, got {env!r}")
    if env is not None:
        check_same(run, env)
    columns = None if layout is None else len(checked_layout(layout, numbered_states(run))[0])
    checked_action_names(run.action_names, action_names)
    began = time.perf_counter()
    config = run.config
    beginning = start_of(run, episode) if env is None else None
    repeated = _repeat(run, episode, env, beginning, progress)
    if beginning is not None and not repeated.agrees_with(beginning, run):
        repeated = _repeat(run, episode, env, None, progress)
    watcher, first = repeated.watcher, episode + 1 - len(repeated.returns)
    for theirs, ours in ((repeated.returns, run.episode_returns), (repeated.lengths, run.episode_lengths)):
        kept = ours[first : episode + 1]
        if theirs.tobytes() != kept.tobytes():
            raise RuntimeError(
                f"the reference does not repeat this run: episode {first + int(np.argmax(theirs != kept))} differs. "
                "Was it trained on another environment, machine or version? qtab.verify(run) compares them"
            )
    names = Names.of(run, repeated.env, columns, action_names)
    explained = range(len(watcher.steps))[start:][:steps]
    return Explanation(
        config=config,
        episode=episode,
        steps=tuple(_explained(run, watcher, index, names) for index in explained),
        episode_length=len(watcher.steps),
        episode_return=float(repeated.returns[-1]),
        learning_rate=_learning_rate(config, episode),
        seconds=time.perf_counter() - began,
    )


@dataclass(frozen=True)
class _Repeated:
    """The repetition by the reference: an episode, and all earlier ones unless it started from that one."""

    watcher: Watcher
    table: NDArray[np.float64]
    returns: NDArray[np.float64]
    lengths: NDArray[np.int64]
    env: gym.Env
    """The environment, for the names that it gives; it may be closed."""

    def agrees_with(self, start: Start, run: Run) -> bool:
        """Returns whether the actions, the return, and every value after the episode are those of Rust.

        An environment that keeps a state from its first episode, such as a bandit problem, differs when it is made
        again. With a learning rate of 0 the values do not show this, but the return does.
        """
        actions = tuple(choice.action for choice in self.watcher.choices[: len(self.watcher.steps)])
        returned = run.episode_returns[start.episode : start.episode + 1]
        return (
            actions == start.columns
            and self.returns.tobytes() == returned.tobytes()
            and self.table.tobytes() == start.tables_after.tobytes()
        )


def _repeat(run: Run, episode: int, env: gym.Env | None, start: Start | None, progress: bool | None) -> _Repeated:
    """Repeats a run with the reference up to the end of an episode, from the first episode or from that one."""
    watcher = Watcher(run.config, lambda row: _cell(run, row), start)
    if env is None:
        made: AbstractContextManager[gym.Env] = closing(make_run_env(run.config))
    else:
        limit = checks.required("max_episode_steps", run.config.max_episode_steps)
        made = nullcontext(gym.wrappers.TimeLimit(env, limit))
    episodes = episode + 1 if start is None else 1
    with made as stepped, ProgressBar(episodes, "episode", progress, "repeating") as bar, observed_by(watcher):
        watched = _Watched(stepped, run, watcher, episodes, bar.move_to)
        table, returns, lengths = LEARNERS[run.config.algorithm](watched, run.config, stop_after=episodes)
    return _Repeated(watcher, table, returns, lengths, stepped)


def _cell(run: Run, row: int) -> tuple[int, ...] | None:
    if not run.discretizer.has_cells:
        return None
    return tuple(int(index) for index in np.unravel_index(row, run.discretizer.shape))


def _learning_rate(config: Config, episode: int) -> float:
    """Returns the learning rate after ``episode`` episodes."""
    schedule = LearningRate(config, (1, 1), 1).schedule
    for _ in range(episode):
        schedule.end_episode()
    return schedule.value


def _explained(run: Run, watcher: Watcher, index: int, names: Names) -> ExplainedStep:
    step, choice = watcher.steps[index], watcher.choices[index]
    pending: tuple[int, ...] = ()
    if run.config.algorithm in N_STEP:
        pending = tuple(range(sum(len(seen.updates) for seen in watcher.steps[: index + 1]), index + 1))
    seen = vars(step) | {
        "updates": tuple(step.updates),
        "policy_updates": tuple(step.policy_updates),
        "planning": tuple(_named(update, update.rows[0], names) for update in step.planning),
        "traces": tuple(_named(trace, trace.row, names) for trace in step.traces),
    }
    return ExplainedStep(
        **seen,
        step=index,
        cell=_cell(run, step.rows[0]),
        state=names.state(step.observation),
        action=run.actions[choice.action],
        action_name=names.actions[choice.action],
        action_names=tuple(names.actions[index] for index in range(len(choice.values))),
        choice=choice,
        next_cell=_cell(run, step.next_rows[0]),
        next_state=names.state(step.next_observation),
        pending=pending,
        note=_note(run.config.algorithm, step),
    )


def _named(record: Record, row: int, names: Names) -> Record:
    """Returns a planning update or a trace with the names of its state and action."""
    return replace(record, state=names.cell(row), action_name=names.actions[record.action])


def _note(algorithm: str, step: SeenStep) -> str:
    """Returns the reason why a step changed no value."""
    if any(update.step != -1 for update in step.updates) or step.policy_updates:
        return ""
    if algorithm in N_STEP:
        return "none yet: n steps are not complete"
    if algorithm == "off_policy_monte_carlo":
        return "none: a later action of the episode is not greedy"
    if algorithm in MONTE_CARLO:
        return "none: the same action was taken in the same cell before in the episode, and first visits count"
    if algorithm in AVERAGE_REWARD:
        return "none yet: it waits for the first state of the next episode"
    return "only those that were planned" if step.planning else "none: no error is large enough for the queue"


class _Watched(gym.Wrapper[Any, Any, Any, Any]):
    """Reports the steps of the last of ``episodes`` episodes to the watcher."""

    def __init__(
        self, env: gym.Env, run: Run, watcher: Watcher, episodes: int, progress: Callable[[int], None]
    ) -> None:
        super().__init__(env)
        self._run, self._watcher, self._episodes, self._progress = run, watcher, episodes, progress
        self._begun = self._steps = 0
        self._observation: Any = None
        self._rows: tuple[int, ...] = ()
        self._features: tuple[float, ...] = ()

    def reset(self, **kwargs: Any) -> Any:
        self._progress(self._begun)
        self._begun += 1
        if self._begun == self._episodes:
            self._watcher.begin()
        start = self._watcher.start
        if start is not None:
            self.env.unwrapped.np_random = restored_generator(start.env_generator)
            kwargs = {}
        observation, info = self.env.reset(**kwargs)
        if self._watcher.active:
            self._steps = 0
            self._observation = observation
            self._rows, self._features = self._active_rows(observation)
        return observation, info

    def step(self, action: Any) -> Any:
        observation, reward, terminated, truncated, info = self.env.step(action)
        if self._watcher.active:
            self._steps += 1
            rows, features = self._active_rows(observation)
            self._watcher.record(
                SeenStep(
                    observation=self._observation,
                    rows=self._rows,
                    reward=float(reward),
                    next_observation=observation,
                    next_rows=rows,
                    terminated=bool(terminated),
                    truncated=bool(truncated),
                    features=self._features,
                    next_features=features,
                )
            )
            self._observation, self._rows, self._features = observation, rows, features
        return observation, reward, terminated, truncated, info

    def _active_rows(self, observation: Any) -> tuple[tuple[int, ...], tuple[float, ...]]:
        """Returns the active rows of an observation, and their features if they are weighted."""
        found = tuple(rows_of(self._run, observation, self._steps).tolist())
        return (tuple(range(len(found))), found) if self._run.discretizer.is_weighted else (found, ())
