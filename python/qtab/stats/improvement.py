"""The probability of improvement (Agarwal et al., 2021)."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from qtab._utils import arrays
from qtab.stats.aggregates import AGGREGATE_RESAMPLES
from qtab.stats.bootstrap import bootstrap
from qtab.stats.interval import Interval
from qtab.stats.intervals import CONFIDENCE
from qtab.stats.scores import Scores, as_samples


def probability_of_improvement(
    a: Scores,
    b: Scores,
    *,
    confidence: float = CONFIDENCE,
    resamples: int = AGGREGATE_RESAMPLES,
    seed: int = 0,
) -> Interval:
    """Returns the probability that a run of ``a`` scores higher than a run of ``b``, averaged over environments.

    All runs of ``a`` are compared with all runs of ``b`` on the same environment; ties count half. 0.5 means that
    neither is better. The interval is the stratified bootstrap's, as in rliable. Unlike :func:`compare`, it does not
    pair the runs by their seeds, and it does not measure the size of the improvement.

    Args:
        a: The scores of the first setting: of each environment by name, (runs,) each; an array (runs, environments);
            or (runs,) for one environment. At least two runs of each environment.
        b: The same for the second setting, on the same environments; the number of runs may differ.
        confidence: The coverage probability of the interval, between 0 and 1.
        resamples: The number of bootstrap resamples, at most a million.
        seed: Seeds the bootstrap.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or different environments.
    """
    first, second = _by_environment("a", a), _by_environment("b", b)
    if list(first) != list(second):
        raise ValueError(f"a and b must have the same environments, got {', '.join(first)} and {', '.join(second)}")
    names = list(first)

    def probability(*samples: NDArray[np.float64]) -> float:
        pairs = zip(samples[: len(names)], samples[len(names) :], strict=True)
        return float(np.mean([_wins(x, y) for x, y in pairs]))

    samples = [*(first[name] for name in names), *(second[name] for name in names)]
    return bootstrap(samples, probability, confidence, resamples, seed, stratified=True)


def _wins(x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    """Returns the proportion of all pairs in which ``x`` is larger; ties count half."""
    ordered = np.sort(y)
    below, not_above = np.searchsorted(ordered, x, "left"), np.searchsorted(ordered, x, "right")
    return float(np.mean(below + not_above)) / (2 * len(y))


def _by_environment(name: str, scores: Scores) -> dict[str, NDArray[np.float64]]:
    """Returns the scores by environment, sorted by name; the environments of an array are numbered."""
    if isinstance(scores, Mapping):
        return dict(sorted(zip(map(str, scores), as_samples(name, scores, least=2), strict=True)))
    array = arrays.numbers(name, scores)
    samples = as_samples(name, array[:, np.newaxis] if array.ndim == 1 else array, least=2)
    return {str(index): sample for index, sample in enumerate(samples)}
