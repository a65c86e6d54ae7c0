"""``qtab.Run``: the result of a training run."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks, html
from qtab._utils.fields import with_fields
from qtab._utils.shown import last_of, plural
from qtab.config import Config
from qtab.config.origin import trained_on
from qtab.discretizers import Discretizer
from qtab.envs.actions import Actions
from qtab.envs.origin.description import EnvironmentDescription
from qtab.results import action_values, time_steps
from qtab.results.axes import Axis, action_names, axes_of, run_quantities
from qtab.results.page import WithPage
from qtab.results.recording import Recording as Recording
from qtab.results.recording import Snapshots
from qtab.results.run_state import RunState
from qtab.results.summary import FINAL_EPISODES, block_means, default_block

if TYPE_CHECKING:
    import pandas as pd


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class Run(WithPage):
    """A finished or interrupted run: its config, its episodes and the learned tables."""

    config: Config
    """Everything needed to repeat the run; defaults and preset are filled in."""
    tables: NDArray[np.float64]
    """(k, rows, actions): the Q tables; two for Double Q-learning, else one. Policy gradient methods have preferences
    in the first table and state values, if learned, in the second, where all columns of a row hold its value."""
    episode_returns: NDArray[np.float64]
    """(episodes,): the sum of rewards of each finished episode."""
    episode_lengths: NDArray[np.int64]
    """(episodes,): the number of steps of each finished episode."""
    terminated: NDArray[np.bool_]
    """(episodes,): whether each episode ended in a terminal state, not only by its time limit."""
    discretizer: Discretizer
    """Maps observations to rows of the tables."""
    actions: Actions
    """The environment's actions, in the order of the columns of the tables."""
    completed: bool
    """False after an early stop; the tables then include the updates of an unfinished episode."""
    seconds: float
    """The wall-clock time of the training."""
    versions: Mapping[str, str]
    """The versions of qtab, Gymnasium, NumPy and Python, and the platform."""
    recordings: tuple[Recording, ...] = field(default=(), repr=False)
    """The last episodes, for replay, if ``record=`` was given. They are not saved."""
    unchecked: bool = field(default=False, repr=False)
    """True for a run from a file of an earlier version, which has no digest to detect damage."""
    visits: NDArray[np.int64] | None = field(default=None, repr=False)
    """(*cells, actions): how often each action was taken in each cell; None without ``visits=True``. With tile coding
    (rows, actions): a step counts once for each weight of its action, one in each tiling."""
    snapshots: Snapshots | None = field(default=None, repr=False)
    """The tables at several episodes; None without ``snapshots=``."""
    action_masks: NDArray[np.bool_] | None = field(default=None, repr=False)
    """(*cells, actions): the last mask seen in each cell; True in cells never seen. None without ``action_mask=``,
    and with tile coding."""
    average_reward: float | None = field(default=None, repr=False)
    """The average reward per step that differential Sarsa or Q-learning learned; None for other algorithms, for
    runs of ``train_many`` and from files of earlier versions."""
    state: RunState | None = field(default=None, repr=False)
    """The state for :func:`qtab.resume`; None for runs of ``train_many`` and from files of earlier versions."""

    def __repr__(self) -> str:
        """Returns one line, without the tables."""
        config, finished = self.config, len(self.episode_returns)
        of_all = "" if self.completed else f" of {config.episodes}"
        episodes = f"{finished}{of_all} {plural('episode', config.episodes)}"
        last = self.episode_returns[-FINAL_EPISODES:]
        mean = f", the {last_of(len(last))} at {last.mean():.2f}" if finished else ""
        unchecked = ", from a file without a digest" if self.unchecked else ""
        return f"<Run of {config.env}: {config.algorithm}, seed {config.seed}, {episodes}{mean}{unchecked}>"

    def _repr_html_(self) -> str:
        """Returns a table and the learning curve, for notebooks."""
        config, returns = self.config, self.episode_returns
        facts: dict[str, object] = {
            "algorithm": f"{config.algorithm}, seed {config.seed}",
            "episodes": f"{len(returns):,}" + ("" if self.completed else f" of {config.episodes:,}"),
            "table": " × ".join(f"{size:,}" for size in self.tables.shape),
            "time": f"{self.seconds:.3g} s",
        }
        if len(returns):
            last = returns[-FINAL_EPISODES:]
            facts |= {f"mean of the last {len(last)}": f"{last.mean():.2f}", "best return": f"{returns.max():.6g}"}
        if self.average_reward is not None:
            facts["average reward"] = f"{self.average_reward:.6g}"
        if self.unchecked:
            facts["file"] = "of an earlier version, without a digest"
        block = min(default_block(len(returns)), max(len(returns) // 20, 1))
        each = f"Learning curve: the mean return of each {block:,} episodes"
        label = each if block > 1 else "The return of each episode"
        return html.summary(f"Run of {config.env}", facts, html.lines(label, {"mean return": self.mean_returns(block)}))

    @property
    def trained_on(self) -> EnvironmentDescription | None:
        """The environment in detail, as it was when training began; None if a file does not store it."""
        return trained_on(self.config)

    @property
    def grid(self) -> Discretizer:
        """An alias of :attr:`discretizer`, its name in earlier versions."""
        return self.discretizer

    @property
    def q_table(self) -> NDArray[np.float64]:
        """(*cells, actions): the values that the greedy policy uses; with two tables their sum; -inf if masked.

        With ``time_aware`` the axis of the steps comes first: ``q_table[t]`` are the values after t steps. For policy
        gradient methods, the values are preferences; the policy is their softmax.

        Raises:
            ValueError: with tile coding, which has no cells.
        """
        self._require_cells("q_table", "q_values")
        return action_values.of_cells(self)

    @property
    def policy(self) -> Any:
        """(*cells,): the greedy action of each cell, the first in a tie; (*cells, *shape) if actions are arrays.

        For a Tuple or Dict space it is a tuple or dict of such arrays.

        Raises:
            ValueError: with tile coding, which has no cells; :meth:`predict` works.
        """
        self._require_cells("policy", "predict")
        return self.actions.take(np.argmax(self.q_table, axis=-1))

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The name, the unit and the edges of the cells of each component of the observation."""
        return axes_of(run_quantities(self.config, self.discretizer), self.discretizer)

    @property
    def action_names(self) -> tuple[str, ...]:
        """(actions,): Gymnasium's words for the actions, such as "push left", or the values of continuous ones."""
        return action_names(run_quantities(self.config, self.discretizer), self.actions)

    def _require_cells(self, attribute: str, method: str) -> None:
        if not self.discretizer.has_cells:
            raise ValueError(
                f"{attribute} needs cells, which discretizer {self.config.discretizer!r} does not have; "
                f"run.{method}(observation) works"
            )

    def at_step(self, step: int) -> "Run":
        """Returns the part of a run with ``time_aware=True`` for one step of the episode, to inspect like any run.

        Its tables, visits, masks and snapshots are those after ``step`` steps; its config has ``time_aware=False``. It
        can neither be repeated nor resumed.

        Raises:
            TypeError: if ``step`` is not an integer.
            ValueError: if ``step`` is negative or not below the time limit, or not 0 for a run without ``time_aware``.
        """
        return time_steps.at_step(self, step)

    def q_values(self, observation: Any, step: int = 0) -> NDArray[np.float64]:
        """Returns the (actions,) values of an observation, or the (n, actions) values of n observations.

        For policy gradient methods, they are preferences. With ``time_aware``, they apply after ``step`` steps.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space).
            ValueError: if the observation does not have the shape of the space or lies outside it; or for a ``step`` as
                in :meth:`at_step`.
        """
        return action_values.of_observations(self, observation, time_steps.checked_step(self.discretizer, step))

    def values(self, observation: Any, step: int = 0) -> Any:
        """Returns the value of an observation under the greedy policy, or the (n,) values of n observations.

        The value is the largest action value, as a float. For Double Q-learning, whose :attr:`q_table` is the sum of
        two tables, it is half of that: the mean of two estimates. For REINFORCE with baseline and actor-critic methods
        it is the learned state value. With ``time_aware`` it is the value after ``step`` steps.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space).
            ValueError: if the observation does not have the shape of the space or lies outside it; for an algorithm
                that learns only preferences; or for a ``step`` as in :meth:`at_step`.
        """
        step = time_steps.checked_step(self.discretizer, step)
        values = action_values.state_values(self, observation, step)
        return values if values.ndim else float(values)

    def predict(
        self,
        observation: Any,
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = True,
        action_masks: ArrayLike | None = None,
    ) -> tuple[Any, Any]:
        """Returns the action for an observation, in the form ``env.step`` takes, and the policy's state, as in SB3.

        The action has the type of the action space's samples: an integer, an array, or a tuple or a dict of these. For
        n observations, batched as in Gymnasium's vector environments, it returns an array of n actions. The policy
        of a run with ``time_aware=True`` has a state, the number of steps taken in the episode; pass it to the next
        call. From the time limit on, the policy acts as in the last step. Any other run returns None as the state.

        Args:
            observation: An observation, or n of them.
            state: The state that the last call returned, (n,) for n observations; None for the start of an episode.
                Ignored without ``time_aware``.
            episode_start: Whether an episode starts, (n,) booleans for n observations; None means no. Ignored without
                ``time_aware``.
            deterministic: True takes the greedy action; with preferences, the most likely one. False draws an action
                from the behaviour policy, with the ε or the temperature at the end of the training: an ε that fell to
                0 gives the greedy action, as does exploration "ucb". The draws come from a separate generator, seeded
                by the run's seed, whose numbers differ from those of the training.
            action_masks: (actions,) or (n, actions): the allowed actions. None uses the run's ``action_mask``.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space), or ``deterministic`` is
                not a boolean.
            ValueError: if the observation does not have the shape of the space or lies outside it.
        """
        deterministic = checks.boolean("deterministic", deterministic)
        steps = time_steps.steps_taken(self.discretizer, state, episode_start)
        values = action_values.to_choose_from(self, observation, action_masks, steps)
        if deterministic:
            columns = np.argmax(values, axis=-1)
        else:
            rows = values.reshape(-1, values.shape[-1])
            probabilities = action_values.action_probabilities(self.config, len(self.episode_returns), rows)
            columns = action_values.sample(probabilities, self._generator).reshape(values.shape[:-1])
        action = self.actions.take(columns) if columns.ndim else self.actions[int(columns)]
        return action, time_steps.next_state(self.discretizer, steps, columns.shape)

    @cached_property
    def _generator(self) -> np.random.Generator:
        """The generator of :meth:`predict`: the seed's second child. With PCG64, the agent trains with the first."""
        return np.random.default_rng(np.random.SeedSequence(self.config.seed).spawn(2)[1])

    def mean_returns(self, block: int = 100) -> NDArray[np.float64]:
        """Returns (blocks,): the average return of each whole block of episodes, as plotted in the article.

        Episodes after the last whole block do not count: with fewer episodes than ``block``, the result is empty.

        Raises:
            TypeError: if ``block`` is not an integer.
            ValueError: if ``block`` is less than one.
        """
        block = checks.integer("block", block, least=1)
        means: NDArray[np.float64] = block_means(self.episode_returns[np.newaxis], block)[0]
        return means

    def to_pandas(self) -> "pd.DataFrame":
        """Returns a data frame with one row per episode: its number, its return, its length and how it ended.

        Raises:
            ModuleNotFoundError: without pandas; the message names the ``pip install``.
        """
        from qtab._utils.data_frames import episode_frame

        return episode_frame(self.episode_returns, self.episode_lengths, self.terminated)

    def to_json(self, path: "str | os.PathLike[str]") -> None:
        """Writes the greedy policy as plain data: tables, discretizer, actions. ``docs/how_to/export.md`` has its keys.

        Raises the exceptions of :meth:`save`.
        """
        from qtab.results.files import plain_data

        plain_data.write(self, checks.file_path("path", path))

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes the run to one ``.npz`` file: arrays and a JSON header, never a pickle. :func:`qtab.load` reads it.

        The file includes a digest, with which :func:`qtab.load` detects any change. If ``path`` is a symbolic link, its
        target is replaced.

        Raises:
            OSError: if the file cannot be written, or ``path`` exists and is not a regular file. An older file stays
                intact, even if the process is killed.
            TypeError: if the environment's keyword arguments are not JSON data.
            ValueError: if they hold a number that JSON cannot represent, or the run is not one that training returns,
                such as one whose values overflowed.
        """
        from qtab.results.files.file_parts import write_run

        write_run(self, path)
