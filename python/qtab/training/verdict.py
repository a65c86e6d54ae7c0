"""Decides whether a run solved its environment; the only definition of "solved"."""

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from qtab._utils.shown import last_of
from qtab.config import Config
from qtab.config.choices import IN_PYTHON
from qtab.config.options import PREFERENCES
from qtab.envs.metadata.goals import (
    BEST_KNOWN_MOUNTAIN_CAR,
    is_usual_mountain_car,
    registered_threshold,
    threshold_of,
    why_no_threshold,
)
from qtab.results.action_values import are_finite
from qtab.results.run import Run
from qtab.results.summary import SOLVED_EPISODES, KnownOptimum
from qtab.training.evaluate import evaluate
from qtab.training.setup.run_env import can_be_made

EVALUATION_EPISODES = 100
"""The number of episodes to play with the greedy policy if its return is not computed exactly."""


@dataclass(frozen=True)
class Goal:
    """The return from which a run counts as solved."""

    threshold: float | None
    """Gymnasium's threshold, if it applies."""
    best: float | None = None
    """The return of the best policy that the run could learn, if known."""
    label: str = ""
    """The description of ``best`` in messages."""
    registered: float | None = None
    """The registered threshold of the environment, even if it does not apply."""

    @property
    def least(self) -> float | None:
        """The threshold; if there is none or no policy reaches it, 2 % below the best return, or None if unknown."""
        if self.threshold is not None and (self.best is None or self.threshold <= self.best):
            return self.threshold
        return None if self.best is None else self.best - max(0.02 * abs(self.best), 0.01)

    def __str__(self) -> str:
        counts = "" if self.least is None else f"{self.least:.4g} or more counts as solved"
        if self.threshold is None:
            return "" if self.best is None else f"{self.label} {self.best:.4g}: {counts}"
        if self.least == self.threshold:
            return f"threshold {self.threshold:g}"
        return f"threshold {self.threshold:g}, above the {self.label} {self.best:.4g}: {counts}"


@dataclass(frozen=True)
class Verdict:
    """Whether a run solved its environment, and the returns that decide it. ``str`` lists the returns."""

    solved: bool | None
    """True if the greedy policy's return reaches the goal or, if that return is not exact, the mean of the last 100
    training episodes does. None if there is no goal, or neither is known."""
    goal: Goal
    last: int
    """The number of last training episodes averaged: 100, or all if there are fewer, which then do not count."""
    final_return: float
    """The mean return of the last training episodes."""
    greedy_return: float | None
    """The mean return of the greedy policy; None if it was not measured, because there is no goal or Rust does not
    step the environment."""
    greedy_is_exact: bool
    """Whether the greedy return was computed from a transition table instead of from 100 episodes."""
    why_unknown: str = ""
    """The reason why ``solved`` is None."""

    def numbers(self) -> dict[str, Any]:
        """Returns the verdict as plain values, for JSON."""
        return {
            "threshold": self.goal.threshold,
            "goal_return": self.goal.least,
            "greedy_return": self.greedy_return,
            "solved": self.solved,
        }

    def __str__(self) -> str:
        episodes = last_of(self.last, "training episode")
        text = f"the {episodes} {self.final_return:.4g}" if self.last else "no training episode was finished"
        if self.greedy_return is not None:
            over = "" if self.greedy_is_exact else f" over {EVALUATION_EPISODES} episodes"
            text += f"; greedy policy {self.greedy_return:.4g}{over}"
        return f"{text}, {self.goal}" if str(self.goal) else text


def judge(run: Run, optimum: KnownOptimum | None) -> Verdict:
    """Decides whether a run solved its environment.

    Args:
        run: The run.
        optimum: The optimum of its environment, if known; see :func:`qtab.planning.solve.quick_optimum`.
    """
    goal, last = _goal(run.config, optimum), run.episode_returns[-SOLVED_EPISODES:]
    final = float(last.mean()) if len(last) else float("nan")
    if goal.least is None:
        return Verdict(
            None, goal, len(last), final, None, False, f"{why_no_threshold(run.config)}, and no optimum is known"
        )
    if not are_finite(run):
        return Verdict(False, goal, len(last), final, None, False)
    greedy, exact = _greedy_return(run, optimum)
    reached = [] if greedy is None else [greedy >= goal.least]
    if len(last) == SOLVED_EPISODES and not exact:
        reached.append(final >= goal.least)
    why = "" if reached else f"there are fewer than {SOLVED_EPISODES} training episodes"
    return Verdict(any(reached) if reached else None, goal, len(last), final, greedy, exact, why)


def _greedy_return(run: Run, optimum: KnownOptimum | None) -> tuple[float | None, bool]:
    """Returns the return of a run's greedy policy, and whether it is exact; None if Rust cannot play it.

    With preferences the trained policy is their softmax, so the exact return of the greedy policy would not decide
    whether the run is solved. Episodes are played instead, and the training episodes count as well.
    """
    if optimum is not None and optimum.exact and run.config.algorithm not in PREFERENCES:
        with suppress(ValueError):  # the rows of the table are not the states
            return float(optimum.solver.greedy_return(run)[0]), True
    if run.config.backend in IN_PYTHON or not can_be_made(run.config):
        return None, False
    return evaluate(run, EVALUATION_EPISODES, seed=0, progress=False).mean_return, False


def _goal(config: Config, optimum: KnownOptimum | None) -> Goal:
    goal = Goal(threshold_of(config), registered=registered_threshold(config.env))
    if optimum is None:
        return (
            replace(goal, best=BEST_KNOWN_MOUNTAIN_CAR, label="best known") if is_usual_mountain_car(config) else goal
        )
    goal = replace(goal, best=optimum.expected_return, label=optimum.label)
    within_reach = goal.threshold is not None and goal.threshold <= optimum.expected_return
    if within_reach or config.time_aware or not optimum.exact or optimum.stationary is None:
        return goal
    best = optimum.stationary.expected_return  # the best policy that does not depend on the step count
    if np.isclose(best, optimum.expected_return, rtol=1e-9, atol=1e-12):
        return goal
    return replace(goal, best=best, label="best return without a count of the steps")
