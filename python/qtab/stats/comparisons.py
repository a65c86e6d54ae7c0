"""Paired comparison of two settings that were trained with the same seeds."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from qtab._utils import checks, html
from qtab.stats.bootstrap import BATCH_VALUES, as_resamples, as_sample
from qtab.stats.interval import Interval
from qtab.stats.intervals import CONFIDENCE, RESAMPLES, mean


@dataclass(frozen=True, repr=False)
class Comparison:
    """The result of a paired comparison; all differences are ``a`` minus ``b``."""

    difference: Interval
    """The mean difference with Student's t interval."""
    effect_size: float | None
    """Cohen's d of paired samples: the mean of the differences divided by their standard deviation; 0 if all
    differences are 0, None if all are equal and not 0, because their standard deviation is then 0."""
    better: float
    """The proportion of pairs in which ``a`` is larger; ties count half."""
    p_value: float
    """The p-value of the two-sided permutation test: the proportion of random swaps within the pairs that give a mean
    difference at least as large."""
    pairs: int
    """The number of pairs."""
    resamples: int = RESAMPLES
    """The number of permutations that the test drew at random; if there are no more in all, it tried each of them."""

    @property
    def smallest_p_value(self) -> float:
        """The smallest p-value that the test can give, which is that of differences with the same sign.

        It is 2 / 2**pairs if the test tried all permutations, else 2 / (resamples + 1).
        """
        return 2.0 / min(1 << self.pairs, self.resamples + 1)

    def __repr__(self) -> str:
        """Returns one line."""
        return f"<Comparison: {self}>"

    def _repr_html_(self) -> str:
        """HTML for notebooks: a table."""
        effect = "none: all differences are equal" if self.effect_size is None else f"{self.effect_size:.3g}"
        facts = {
            "mean difference, a - b": f"{self.difference}",
            "interval": f"{100 * self.difference.confidence:g} %, {self.difference.method}",
            "effect size (Cohen's d)": effect,
            "a is larger": f"in {self.better:.1%} of the pairs",
            "p-value": f"{self.p_value:.3g}, at least {self.smallest_p_value:.3g} with {self._limit}",
        }
        return html.summary(f"Comparison of {self.pairs} pairs", facts)

    def __str__(self) -> str:
        if self.effect_size is None:
            effect = f"no effect size (all {self.pairs} differences are equal)"
        else:
            effect = f"effect size {self.effect_size:.3g}"
        text = f"difference {self.difference}, {effect}, better in {self.better:.1%} of {self.pairs} pairs"
        text += f", p = {self.p_value:.3g}"
        if self.smallest_p_value > 1 - self.difference.confidence:
            text += f" (at least {self.smallest_p_value:.3g} with {self._limit}: too few for a significant one)"
        return text

    @property
    def _limit(self) -> str:
        """The number of pairs or permutations that limits the p-value, as text."""
        return f"{self.pairs} pairs" if 2**self.pairs <= self.resamples else f"{self.resamples} permutations"


def compare(
    a: ArrayLike, b: ArrayLike, *, confidence: float = CONFIDENCE, resamples: int = RESAMPLES, seed: int = 0
) -> Comparison:
    """Compares two settings that were trained with the same seeds.

    Args:
        a: (runs,): one number per run of the first setting.
        b: (runs,): the same for the second setting; ``b[i]`` has the same seed as ``a[i]``.
        confidence: The coverage probability of the interval, between 0 and 1.
        resamples: The number of permutations that the test draws, at most a million; it tries all of them if there are
            no more.
        seed: Seeds the test.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, samples of different sizes, or fewer than two pairs.
    """
    first, second = as_sample("a", a), as_sample("b", b)
    if len(first) != len(second):
        raise ValueError(f"a and b must have the same length, got {len(first)} and {len(second)}")
    resamples, seed = as_resamples(resamples), checks.integer("seed", seed, least=0)
    differences = first - second
    effect: float | None
    if not differences.any():
        p_value, effect = 1.0, 0.0
    else:
        effect = None if np.ptp(differences) == 0 else float(np.mean(differences) / np.std(differences, ddof=1))
        # Swapping the values of a pair changes the sign of its difference.
        p_value = stats.permutation_test(
            (differences,),
            _mean,
            permutation_type="samples",
            vectorized=True,
            n_resamples=resamples,
            batch=max(1, BATCH_VALUES // (4 * len(differences))),
            rng=np.random.default_rng(seed),
        ).pvalue
    return Comparison(
        difference=mean(differences, confidence=confidence),
        effect_size=effect,
        better=float(np.mean((differences > 0) + 0.5 * (differences == 0))),
        p_value=float(p_value),
        pairs=len(differences),
        resamples=resamples,
    )


def _mean(differences: NDArray[np.float64], axis: int) -> Any:
    return np.mean(differences, axis=axis)
