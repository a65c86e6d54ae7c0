"""What is measured of a setting's runs: from an outcome to (runs, points)."""

import numpy as np

from qtab.book.experiment import Measure, Numbers
from qtab.book.trials import Outcome
from qtab.results.summary import FINAL_EPISODES


def lengths(outcome: Outcome) -> Numbers:
    """Returns the steps of each episode."""
    return outcome.lengths.astype(np.float64)


def returns(outcome: Outcome) -> Numbers:
    """Returns the sum of rewards of each episode."""
    return outcome.returns


def mean_length(outcome: Outcome) -> Numbers:
    """Returns the steps an episode takes on average."""
    means: Numbers = outcome.lengths.mean(axis=1, keepdims=True)
    return means


def mean_return(outcome: Outcome) -> Numbers:
    """Returns the reward an episode brings on average."""
    means: Numbers = outcome.returns.mean(axis=1, keepdims=True)
    return means


def final_return(outcome: Outcome) -> Numbers:
    """Returns the reward that each of the last 100 episodes brings on average."""
    means: Numbers = outcome.returns[:, -FINAL_EPISODES:].mean(axis=1, keepdims=True)
    return means


def episodes_by(times: tuple[int, ...]) -> Measure:
    """Returns the measure of how many episodes are finished after so many time steps each."""

    def measure(outcome: Outcome) -> Numbers:
        ends = outcome.lengths.cumsum(axis=1)
        return np.stack([(ends <= time).sum(axis=1) for time in times], axis=1).astype(np.float64)

    return measure
