"""Section 9.5.2: the Fourier basis and tile coding on Mountain Car, after Konidaris' comparison, which the book cites.

The article is G. Konidaris, S. Osentoski and P. Thomas, "Value function approximation in reinforcement learning using
the Fourier basis", AAAI 2011. It uses Sarsa(λ), and also compares radial basis functions and polynomials.
"""

from collections.abc import Mapping
from typing import Any

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.problems import ENV, TILE_CODING
from qtab.book.setting import Setting, lengths

METHOD: Mapping[str, Any] = {"algorithm": "sarsa", "episodes": 100}
"""The learner and its episodes, which all bases share."""
COMMON: Mapping[str, Any] = {
    name: value for name, value in TILE_CODING.items() if name not in ("discretizer", "tilings", "tiles")
}
"""The settings of the book's other experiments on Mountain Car, without those of tile coding."""
BASES: Mapping[str, Mapping[str, Any]] = {
    "Fourier basis, order 3, α = 0.05": {"discretizer": "fourier", "order": 3, "learning_rate": 0.05},
    "Fourier basis, order 5, α = 0.08": {"discretizer": "fourier", "order": 5, "learning_rate": 0.08},
    "Fourier basis, order 7, α = 0.08": {"discretizer": "fourier", "order": 7, "learning_rate": 0.08},
    "8 tilings, α = 1.3/8": {"discretizer": "tiles", "tilings": 8, "tiles": 8, "learning_rate": 1.3},
}
"""The settings of each basis by the name of its line, with the best of seven step sizes."""

EXPERIMENT = TrainingExperiment(
    name="section-9.5.2",
    title="the Fourier basis and tile coding on Mountain Car",
    book="no figure; the article that it cites (Konidaris, Osentoski & Thomas, 2011) compares Fourier bases of order "
    "3, 5 and 7 with other bases, by Sarsa(λ)",
    unspecified="everything else: one-step Sarsa, ε = 0, initial weights of zero, 100 episodes, 100 runs; α is the one "
    "with the fewest steps in 20 other runs, of 0.01, 0.02, 0.03, 0.05, 0.08, 0.12 and 0.2 for the Fourier basis, and "
    "of 0.2, 0.3, 0.5, 0.7, 0.9, 1.1 and 1.3, divided by 8, for tile coding",
    settings=tuple(Setting(name, ENV, {**COMMON, **METHOD, **basis}, lengths) for name, basis in BASES.items()),
    runs=100,
    x_label="episode",
    y_label="steps per episode",
    table_x=(1, 2, 5, 10, 20, 50, 100),
    log_y=True,
    y_range=(100, 1500),
)
