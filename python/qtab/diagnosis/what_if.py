"""``Diagnosis.what_if``: tries changes of the settings, one at a time, with the same seeds."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils import html
from qtab._utils.progress import ProgressBar, check_progress
from qtab._utils.shown import counted
from qtab.config import Config
from qtab.config.origin import copied
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, as_keywords, number_text
from qtab.results.runs import Runs
from qtab.training.setup.run_env import as_in_training, make_run_env
from qtab.training.train_many import resolve_template, seed_numbers, train_many
from qtab.training.verdict import judge

if TYPE_CHECKING:
    from qtab.stats.comparisons import Comparison


@dataclass(frozen=True, eq=False, repr=False)
class Trial:
    """A change that was tried."""

    change: Mapping[str, Any]
    """The settings that were changed, as keyword arguments of :func:`qtab.train`."""
    finding: str
    """The name of the finding that advises it."""
    returns: NDArray[np.float64]
    """(seeds,): the mean return of the last 100 episodes, for each seed."""
    comparison: "Comparison | None"
    """The comparison with the run's settings, paired by seed; None if those diverge."""
    solved: int | None
    """The number of seeds that solved the environment; None if neither threshold nor optimum is known."""

    def __repr__(self) -> str:
        """Returns one line: the change and its gain."""
        gained = "" if self.comparison is None else f", difference {_interval(self.comparison)}"
        solved = "" if self.solved is None else f", {self.solved} of {counted(len(self.returns), 'seed')} solved"
        change = as_keywords(self.change)
        return f"<Trial of {change}: mean return {number_text(float(self.returns.mean()))}{gained}{solved}>"


@dataclass(frozen=True, eq=False, repr=False)
class WhatIf:
    """The changes that a diagnosis advises, each tried over the same seeds. The best is first."""

    config: Config
    """The settings without a change."""
    seeds: tuple[int, ...]
    """The seeds of all runs."""
    returns: NDArray[np.float64]
    """(seeds,): the mean return of the last 100 episodes without a change; NaN if a run diverged."""
    solved: int | None
    """The number of seeds that solved the environment without a change; None if it is not known."""
    results: tuple[Trial, ...]
    """The changes, by their mean return."""
    failed: Mapping[str, str]
    """The changes that could not be trained, with the reason."""

    @property
    def best(self) -> Trial:
        """The change with the largest mean return."""
        return self.results[0]

    def __repr__(self) -> str:
        """Returns the whole table, so that interactive Python shows it."""
        return str(self)

    def __str__(self) -> str:
        rows = self._rows()
        widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
        lines = [
            "  ".join([row[0].ljust(widths[0]), *(cell.rjust(w) for cell, w in zip(row[1:], widths[1:], strict=True))])
            for row in rows
        ]
        return "\n".join([self._heading(), *lines, *self._failures()])

    def _repr_html_(self) -> str:
        """HTML for notebooks: the changes as a table."""
        columns, *rows = self._rows()
        return html.sentences(self._heading(), columns, rows, self._failures())

    def _heading(self) -> str:
        config, seeds = self.config, counted(len(self.seeds), "seed")
        return (
            f"{config.env}, {config.algorithm}: one change at a time over {seeds}, mean return of the last 100 episodes"
        )

    def _rows(self) -> list[list[str]]:
        rows = [["change", "return", "difference, 95 % interval", "solved"]]
        diverged = bool(np.isnan(self.returns).any())
        rows.append(
            ["none", "diverged" if diverged else number_text(float(self.returns.mean())), "", self._share(self.solved)]
        )
        for trial in self.results:
            difference = "" if trial.comparison is None else _interval(trial.comparison)
            mean = number_text(float(trial.returns.mean()))
            rows.append([as_keywords(trial.change), mean, difference, self._share(trial.solved)])
        return rows

    def _share(self, solved: int | None) -> str:
        return "not known" if solved is None else f"{solved} of {len(self.seeds)}"

    def _failures(self) -> list[str]:
        return [f"{change} failed: {reason}" for change, reason in self.failed.items()]


def try_changes(facts: Facts, findings: Sequence[Finding], seeds: int | Iterable[int], progress: bool | None) -> WhatIf:
    """Trains the settings of a run, and each change that the findings advise; see :meth:`qtab.Diagnosis.what_if`."""
    from qtab.stats import compare

    check_progress(progress)
    config = facts.config
    changes = {as_keywords(change): (finding.name, change) for finding in findings for change in finding.changes}
    if not changes:
        raise ValueError("no finding advises a change of the settings: there is nothing to try")
    try:
        make_run_env(config).close()
    except gym.error.UnregisteredEnv:
        raise ValueError(
            f"what_if needs an environment with an id to make it again, and {config.env} has none"
        ) from None
    except ValueError as error:
        reason = str(error).removeprefix("env must be given: ")
        raise ValueError(f"what_if must make the environment of the run again: {reason}") from None
    numbers = seed_numbers(seeds)
    if len(numbers) < 2:
        raise ValueError(f"seeds must be at least 2, to compare them in pairs, got {len(numbers)}")
    results, failed = [], {}
    with ProgressBar((1 + len(changes)) * len(numbers), "run", progress, "what if") as bar:
        try:
            runs = _train(facts, {}, numbers, bar, 0)
            before, solved = runs.final_returns(), _solved(facts, runs)
        except OverflowError:
            before, solved = np.full(len(numbers), np.nan), None if facts.goal_return is None else 0
        for done, (text, (name, change)) in enumerate(changes.items(), 1):
            try:
                runs = _train(facts, change, numbers, bar, done)
            except (OverflowError, ValueError) as error:
                failed[text] = str(error)
                bar.move_to((done + 1) * len(numbers))
                continue
            returns = runs.final_returns()
            comparison = None if np.isnan(before).any() else compare(returns, before)
            results.append(Trial(change, name, returns, comparison, _solved(facts, runs)))
    results.sort(key=lambda trial: -float(trial.returns.mean()))
    return WhatIf(config, numbers, before, solved, tuple(results), failed)


def _train(facts: Facts, change: Mapping[str, Any], seeds: Sequence[int], bar: ProgressBar, done: int) -> Runs:
    """Trains with a change, and advances the bar, on which ``done`` changes are finished.

    A preset replaces all settings except for those of the environment.
    """
    config = facts.config
    watched: dict[str, Any] = {"progress": False, "tables": facts.goal_return is not None and facts.can_repeat}
    if bar.is_shown:
        watched["callback"] = lambda progress: bar.move_to(done * len(seeds) + progress.runs)
    if "preset" in change:
        # A config that holds nothing but the environment.
        environment = Config(env=config.env, env_kwargs=config.env_kwargs, max_episode_steps=config.max_episode_steps)
        bare = {"max_episode_steps": config.max_episode_steps}
        _, made, asked = as_in_training(copied(environment, config.origin), {**bare, **change}, resolve_template)
        return train_many(made, seeds, **watched, **{"env_kwargs": config.env_kwargs, **asked})
    return train_many(config=config, seeds=seeds, **watched, **change)


def _interval(comparison: "Comparison") -> str:
    found = comparison.difference
    return f"{found.estimate:+.4g} [{found.low:+.4g}, {found.high:+.4g}]"


def _solved(facts: Facts, runs: Runs) -> int | None:
    """Returns the number of runs that solved the environment, as :func:`qtab.training.verdict.judge` decides it."""
    if facts.goal_return is None or runs.tables is None:
        return None
    return sum(judge(run, facts.optimum).solved is True for run in runs)
