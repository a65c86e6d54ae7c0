"""The checks of a diagnosis, in the order in which their findings are shown."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from qtab.diagnosis.cells import coarse_grid, narrow_limits, wide_limits
from qtab.diagnosis.exploration import coverage, exploration, lasting_bonus, lasting_exploration
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Unchecked
from qtab.diagnosis.greedy import greedy_loop
from qtab.diagnosis.initial_values import too_optimistic, too_pessimistic
from qtab.diagnosis.learning_rate import divergence, noisy_values, slow_learning
from qtab.diagnosis.returns import not_solved, too_short, unlucky_seed
from qtab.diagnosis.time_limits import horizon, time_limit, truncation


@dataclass(frozen=True)
class Check:
    """A check, and the conditions under which it can be made."""

    find: Callable[[Facts], Finding | Unchecked | None]
    """Returns the finding, None if there is nothing to report, or the reason why the check could not be made."""
    repeats: bool = False
    """Whether it repeats the run, for which Rust must step the environment."""
    if_solved: bool = False
    """Whether it is also made for a run that solved its environment."""
    reads_values: bool = False
    """Whether it reads action values, or advises on exploration that compares them. It is then not made for a run that
    learned preferences, whose policy is their softmax."""


CHECKS: Mapping[str, Check] = {
    "not solved": Check(not_solved),
    "divergence": Check(divergence, if_solved=True, reads_values=True),
    "horizon": Check(horizon),
    "short time limit": Check(time_limit),
    "greedy loop": Check(greedy_loop, reads_values=True),
    "grid too coarse": Check(coarse_grid, repeats=True),
    "limits too narrow": Check(narrow_limits, repeats=True),
    "limits too wide": Check(wide_limits, repeats=True),
    "coverage": Check(coverage, reads_values=True),
    "exploration": Check(exploration, repeats=True, reads_values=True),
    "lasting exploration": Check(lasting_exploration),
    "lasting bonus": Check(lasting_bonus),
    "slow learning": Check(slow_learning, reads_values=True),
    "noisy values": Check(noisy_values, repeats=True, reads_values=True),
    "too short": Check(too_short),
    "too optimistic": Check(too_optimistic, reads_values=True),
    "too pessimistic": Check(too_pessimistic, reads_values=True),
    "time-outs treated as terminal": Check(truncation, if_solved=True),
    "unlucky seed": Check(unlucky_seed, repeats=True),
}
"""Each check by the name of its finding."""
