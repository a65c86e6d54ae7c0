"""Makes docs/pictures/thousand_seeds.png: the article's settings and `"solved"`, with 1,000 seeds each."""

import time
from pathlib import Path

import qtab

THRESHOLD = -110.0
"""The mean return of 100 episodes at which Gymnasium considers the task solved."""


def trained(name: str, **settings: str) -> qtab.Runs:
    """Trains 1,000 seeds, and prints the time and the results."""
    began = time.perf_counter()
    runs = qtab.train_many("MountainCar-v0", seeds=1000, **settings)
    final = runs.final_returns(100)
    print(f"{name}: {runs.episode_lengths.sum():,} steps in {time.perf_counter() - began:.1f} s")
    print(f"{name}: {qtab.stats.mean(final)} over the last 100 episodes of {len(runs):,} seeds")
    reached = (final >= THRESHOLD).sum()
    print(f"{name}: from {final.min():.1f} to {final.max():.1f}; {reached:,} of them reach {THRESHOLD:g}")
    return runs


article = trained("article")
solved = trained("solved", preset="solved")
best = qtab.optimum("MountainCar-v0")
print(f"{best.label}: {best.expected_return:.1f}")

ax = qtab.plots.learning_curves(article.episode_returns, label="article")
lines = {"optimum": best, "threshold": THRESHOLD, "title": "MountainCar-v0"}
qtab.plots.learning_curves(solved.episode_returns, ax, label="solved", index=1, **lines)
ax.figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)
