"""Makes docs/pictures/thousand_seeds.png: the article's settings with 1,000 seeds beside `"solved"` with 100."""

import time
from pathlib import Path

import qtab

began = time.perf_counter()
article = qtab.train_many("MountainCar-v0", seeds=1000)
seconds = time.perf_counter() - began
print(f"{article.episode_lengths.sum():,} steps in {seconds:.1f} s")
solved = qtab.train_many("MountainCar-v0", seeds=100, preset="solved")
for name, runs in (("article", article), ("solved", solved)):
    final = runs.final_returns(100)
    print(f"{name}: {qtab.stats.mean(final)} over the last 100 episodes of {len(runs)} seeds, best {final.max():.1f}")

best = qtab.optimum("MountainCar-v0")
print(f"{best.label}: {best.expected_return:.1f}")

ax = qtab.plots.learning_curves(article.episode_returns, label="article")
qtab.plots.learning_curves(solved.episode_returns, ax, label="solved", index=1, optimum=best, title="MountainCar-v0")
ax.figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)
