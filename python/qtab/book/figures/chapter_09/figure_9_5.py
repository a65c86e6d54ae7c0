"""Figure 9.5: the Fourier basis and polynomials on the random walk of 1,000 states."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from qtab._utils.progress import ProgressBar
from qtab.book.experiment import Experiment, Outcome
from qtab.book.figures.chapter_09.long_walk import STATES, gradient_monte_carlo, simulate
from qtab.book.line import LineStyle, line_from_samples
from qtab.book.problems import thousand_states
from qtab.book.runner import FloatArray

ORDERS = (5, 10, 20)
POLYNOMIALS, FOURIER = "polynomials", "Fourier basis"
_EVERY = 50


@dataclass(frozen=True, kw_only=True, repr=False)
class BasisComparison(Experiment):
    """Learning curves of gradient Monte Carlo with bases of several orders, which see the same episodes."""

    alphas: Mapping[str, float]
    """The step size for each basis."""
    episodes: int

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        return [f"{basis}, n = {order}" for basis in self.alphas for order in ORDERS]

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:  # noqa: ARG002
        """Simulates all runs, and then applies all bases to them."""
        record = sorted({0, 1, 10, 25, *range(_EVERY, self.episodes + 1, _EVERY), self.episodes})
        record = [point for point in record if point <= self.episodes]
        pairs = [(basis, order) for basis in self.alphas for order in ORDERS]
        features = [basis_features(basis, order) for basis, order in pairs]
        alphas = [self.alphas[basis] for basis, _ in pairs]
        with ProgressBar(2 * self.episodes, "episode", progress, self.name) as bar:
            walks = simulate(range(seed, seed + runs), self.episodes, bar.move_to)
            longest = max(len(walk.states) for walk in walks)

            def on_steps(steps: int) -> None:
                bar.move_to(self.episodes + steps * self.episodes // longest)

            found = gradient_monte_carlo(walks, features, alphas, record, on_steps)
            bar.move_to(2 * self.episodes)
        exact = thousand_states().true_values
        lines = []
        for name, values, (basis, order) in zip(self.line_names, found, pairs, strict=True):
            errors = np.sqrt(((values - exact.values) ** 2 * exact.state_distribution).sum(axis=-1))
            lines.append(
                line_from_samples(
                    name, record, errors, style=LineStyle(method=f"n = {order}", dashed=basis == POLYNOMIALS)
                )
            )
        return Outcome(lines)


def basis_features(basis: str, order: int) -> FloatArray:
    """Returns (states, order + 1): sⁱ or cos(iπs) for i from 0 to the order, with equally spaced states s in [0, 1]."""
    place = (np.arange(STATES) + 0.5)[:, None] / STATES
    powers = np.arange(order + 1)
    features: FloatArray = place**powers if basis == POLYNOMIALS else np.cos(np.pi * powers * place)
    return features


EXPERIMENT = BasisComparison(
    name="figure-9.5",
    title="the Fourier basis and polynomials",
    book="gradient Monte Carlo on 1,000 states; bases of the orders 5, 10 and 20; α = 1e-4 for polynomials and 5e-5 "
    "for the Fourier basis; 5,000 episodes, 30 runs",
    unspecified="the initial weights (zero here), and the place of a state in [0, 1] ((k - 1/2) / 1,000 for the k-th)",
    alphas={POLYNOMIALS: 1e-4, FOURIER: 5e-5},
    episodes=5_000,
    runs=30,
    x_label="episode",
    y_label="root of the value error VE",
    table_x=(0, 50, 500, 1000, 2000, 3000, 4000, 5000),
    y_range=(0, 0.45),
)
