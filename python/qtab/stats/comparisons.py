"""Paired comparison of two settings that were trained with the same seeds."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from qtab._utils import checks
from qtab.stats.intervals import CONFIDENCE, RESAMPLES, Interval, as_sample, mean


@dataclass(frozen=True)
class Comparison:
    """The result of a paired comparison; all differences are ``a`` minus ``b``."""

    difference: Interval
    """The mean difference with its bootstrap interval."""
    effect_size: float
    """Cohen's d of paired samples: the mean of the differences divided by their standard deviation."""
    better: float
    """The proportion of pairs in which ``a`` is larger; ties count half."""
    p_value: float
    """The p-value of the two-sided permutation test: how often randomly swapping the values within the pairs gives a
    mean difference at least as large."""
    pairs: int
    """The number of pairs."""

    def __str__(self) -> str:
        return (
            f"difference {self.difference}, effect size {self.effect_size:.3g}, better in {self.better:.1%} of "
            f"{self.pairs} pairs, p = {self.p_value:.3g}"
        )


def compare(
    a: ArrayLike, b: ArrayLike, *, confidence: float = CONFIDENCE, resamples: int = RESAMPLES, seed: int = 0
) -> Comparison:
    """Compares two settings that were trained with the same seeds.

    Args:
        a: (runs,): one number per run of the first setting.
        b: (runs,): the same for the second setting; ``b[i]`` has the same seed as ``a[i]``.
        confidence: The coverage probability of the interval, in [0, 1].
        resamples: The number of bootstrap resamples, and of permutations.
        seed: Seeds both.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or samples of different sizes.
    """
    first, second = as_sample("a", a, least=2), as_sample("b", b, least=2)
    if len(first) != len(second):
        raise ValueError(f"a and b must have the same length, got {len(first)} and {len(second)}")
    resamples = checks.integer("resamples", resamples, least=1)
    differences = first - second
    if not differences.any():
        p_value, effect = 1.0, 0.0
    else:
        # Swapping the values of a pair changes the sign of its difference.
        p_value = stats.permutation_test(
            (differences,),
            _mean,
            permutation_type="samples",
            vectorized=True,
            n_resamples=resamples,
            rng=np.random.default_rng(checks.integer("seed", seed, least=0)),
        ).pvalue
        deviation = float(np.std(differences, ddof=1))
        effect = (
            float(np.mean(differences)) / deviation if deviation > 0 else float(np.copysign(np.inf, differences[0]))
        )
    return Comparison(
        difference=mean(differences, confidence=confidence, resamples=resamples, seed=seed),
        effect_size=float(effect),
        better=float(np.mean((differences > 0) + 0.5 * (differences == 0))),
        p_value=float(p_value),
        pairs=len(differences),
    )


def _mean(differences: NDArray[np.float64], axis: int) -> Any:
    return np.mean(differences, axis=axis)
