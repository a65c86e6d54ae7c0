"""Tables whose rows were assigned in an earlier run: the same cells must have the same rows again."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from qtab.config.config import replace_checked
from qtab.discretizers import Sparse
from qtab.results.action_values import read_by_policy, summed
from qtab.results.run import Run
from qtab.training.resolved_run import ResolvedRun


def with_assigned_rows(resolved: ResolvedRun, run: Run) -> ResolvedRun:
    """Returns a run in which a policy only plays, on the rows and with the values of an earlier run."""
    if not isinstance(run.discretizer, Sparse):
        return resolved
    config = replace_checked(resolved.config, initial_q=greedy_table(run))
    return replace(resolved, discretizer=run.discretizer.as_played(), config=config)


def continued(resolved: ResolvedRun, run: Run) -> ResolvedRun:
    """Returns a run that assigns rows where an earlier one stopped."""
    if not isinstance(run.discretizer, Sparse):
        return resolved
    return replace(resolved, discretizer=run.discretizer.as_learned())


def greedy_table(run: Run) -> NDArray[np.float64]:
    """The table that the greedy policy reads: of two the sum, with tile coding as well, whose values are sums, too."""
    return summed(read_by_policy(run.config, run.tables))[np.newaxis]
