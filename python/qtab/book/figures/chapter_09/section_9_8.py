"""Section 9.8: least-squares TD and semi-gradient TD on Boyan's chain, which the book mentions without a figure."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils.progress import ProgressBar
from qtab.book.experiment import Experiment, Outcome
from qtab.book.line import line_from_samples
from qtab.book.runner import FloatArray
from qtab.prediction.linear import LSTD, linear_geometry
from qtab.prediction.reference.off_policy import SemiGradientTD, transitions

ENV = "qtab/BoyanChain-v0"
LEAST_SQUARES = "LSTD"


@dataclass(frozen=True, kw_only=True, repr=False)
class BoyanChain(Experiment):
    """The RMS error over the states after each episode, for LSTD and for TD with several step sizes."""

    episodes: int
    alphas: Sequence[float]
    """The step sizes of TD."""
    epsilon: float
    """ε of LSTD."""

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        return [LEAST_SQUARES, *(f"TD, α = {alpha:g}" for alpha in self.alphas)]

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:  # noqa: ARG002
        """Gives the same episodes to all methods."""
        samples = np.empty((runs, len(self.line_names), self.episodes + 1))
        with ProgressBar(runs, "run", progress, self.name) as bar:
            for run in range(runs):
                samples[run] = self._errors(seed + run)
                bar.move_to(run + 1)
        x = np.arange(self.episodes + 1)
        return Outcome([line_from_samples(name, x, samples[:, row]) for row, name in enumerate(self.line_names)])

    def _errors(self, seed: int) -> FloatArray:
        """Returns (lines, episodes + 1): the errors with a seed."""
        env: Any = gym.make(ENV, disable_env_checker=True)
        geometry = linear_geometry(env.unwrapped, "random", env.unwrapped.features)
        features, values = geometry.features, geometry.values
        policy = np.ones((len(values), 1))
        least_squares = LSTD(features.shape[1], epsilon=self.epsilon)
        others = [SemiGradientTD(np.zeros(features.shape[1]), alpha, 1.0) for alpha in self.alphas]
        weights = [[np.zeros(features.shape[1])] * len(self.line_names)]
        for step in transitions(env, policy, policy, seed):
            x, next_x = features[step.state], features[step.next_state]
            least_squares.update(x, step.reward, next_x, terminated=step.terminated)
            for method in others:
                method.update(x, step.reward, np.zeros_like(x) if step.terminated else next_x, step.rho)
            if step.over:
                weights.append([least_squares.weights, *(method.w.copy() for method in others)])
                if len(weights) > self.episodes:
                    break
        errors: FloatArray = np.sqrt(np.mean((np.array(weights) @ features.T - values) ** 2, axis=-1)).T
        return errors


EXPERIMENT = BoyanChain(
    name="section-9.8",
    title="least-squares TD on Boyan's chain",
    book="no figure; the task is that of J. Boyan (Machine Learning 49, 2002): 13 states, 4 features, exact weights of "
    "-24, -16, -8 and 0",
    unspecified="everything else: ε = 0.01, λ = 0, initial weights of zero, 30 runs of 100 episodes, the same for all "
    "methods",
    episodes=100,
    alphas=(0.02, 0.1, 0.5),
    epsilon=0.01,
    runs=30,
    x_label="episode",
    y_label="RMS error over the states",
    table_x=(0, 1, 2, 5, 10, 20, 50, 100),
    y_range=(0, 14.5),
)
