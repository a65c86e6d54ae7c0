"""Two settings, run for run."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from qtab._utils import checks
from qtab.stats.intervals import CONFIDENCE, RESAMPLES, Interval, mean, sample


@dataclass(frozen=True)
class Comparison:
    """What a paired comparison of two settings found; ``a`` minus ``b`` throughout."""

    difference: Interval
    """The mean difference."""
    effect_size: float
    """Cohen's d of paired samples: the mean difference over the differences' standard deviation."""
    better: float
    """The share of pairs in which ``a`` is larger, ties counted half."""
    p_value: float
    """Of the two-sided permutation test: how often so large a mean difference comes from swapping pairs by chance."""
    pairs: int

    def __str__(self) -> str:
        """The findings in a line."""
        return (
            f"difference {self.difference}, effect size {self.effect_size:.3g}, better in {self.better:.1%} of "
            f"{self.pairs} pairs, p = {self.p_value:.3g}"
        )


def compare(
    a: ArrayLike, b: ArrayLike, *, confidence: float = CONFIDENCE, resamples: int = RESAMPLES, seed: int = 0
) -> Comparison:
    """Compares two settings over the same seeds: ``a[i]`` and ``b[i]`` come from the same one.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or samples that are no pairs.
    """
    first, second = sample("a", a, least=2), sample("b", b, least=2)
    if len(first) != len(second):
        raise ValueError(f"a and b must be pairs, got {len(first)} and {len(second)} numbers")
    resamples = checks.integer("resamples", resamples, least=1)
    differences = first - second
    if not differences.any():
        p_value, effect = 1.0, 0.0
    else:
        # Swapping the numbers of a pair turns the difference's sign.
        p_value = stats.permutation_test(
            (differences,),
            _mean,
            permutation_type="samples",
            vectorized=True,
            n_resamples=resamples,
            rng=np.random.default_rng(checks.integer("seed", seed, least=0)),
        ).pvalue
        spread = float(np.std(differences, ddof=1))
        effect = float(np.mean(differences)) / spread if spread > 0 else float(np.copysign(np.inf, differences[0]))
    return Comparison(
        difference=mean(differences, confidence=confidence, resamples=resamples, seed=seed),
        effect_size=effect,
        better=float(np.mean((differences > 0) + 0.5 * (differences == 0))),
        p_value=float(p_value),
        pairs=len(differences),
    )


def _mean(differences: NDArray[np.float64], axis: int) -> Any:
    return np.mean(differences, axis=axis)
