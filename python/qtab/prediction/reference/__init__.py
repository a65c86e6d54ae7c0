"""The prediction methods in plain NumPy: slow, readable, and equal to Rust to the last bit."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.prediction.reference.common import Prediction
from qtab.prediction.reference.linear import emphatic_td, gtd2, lstd, off_policy_td, tdc
from qtab.prediction.reference.returns import importance_sampling, monte_carlo, offline_lambda_return
from qtab.prediction.reference.td import batch_td, n_step_td, td
from qtab.prediction.reference.traces import td_lambda, true_online_td_lambda

if TYPE_CHECKING:
    from qtab.prediction.estimates import ValueEstimates

METHODS: Mapping[str, Callable[[Prediction], None]] = {
    "td": td,
    "n_step_td": n_step_td,
    "td_lambda": td_lambda,
    "true_online_td_lambda": true_online_td_lambda,
    "offline_lambda_return": offline_lambda_return,
    "monte_carlo": monte_carlo,
    "importance_sampling": importance_sampling,
    "batch_td": batch_td,
    "off_policy_td": off_policy_td,
    "off_policy_td_lambda": td_lambda,
    "gtd2": gtd2,
    "tdc": tdc,
    "emphatic_td": emphatic_td,
    "lstd": lstd,
}
"""Each method by its name."""


def estimate(env: gym.Env, config: Config, estimates: "ValueEstimates", episodes: int) -> NDArray[np.float64]:
    """Returns (n_weights,): the weights after ``episodes`` episodes.

    Args:
        env: The environment, with its time limit.
        config: The task, with the seed of the run.
        estimates: The method, the policies and the features.
        episodes: The number of episodes.
    """
    prediction = Prediction(env, config, estimates, episodes)
    if episodes:
        METHODS[estimates.settings.method](prediction)
    return prediction.w
