"""The prediction methods in plain NumPy: slow, readable, and equal to Rust to the last bit."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.prediction.reference.batch_td import batch_td
from qtab.prediction.reference.common import Prediction
from qtab.prediction.reference.importance_sampling import importance_sampling
from qtab.prediction.reference.monte_carlo import monte_carlo
from qtab.prediction.reference.n_step_td import n_step_td
from qtab.prediction.reference.offline_lambda_return import offline_lambda_return
from qtab.prediction.reference.td import td
from qtab.prediction.reference.td_lambda import td_lambda
from qtab.prediction.reference.true_online_td_lambda import true_online_td_lambda

if TYPE_CHECKING:
    from qtab.prediction.estimates import ValueEstimates

METHODS: Mapping[str, Callable[[Prediction], None]] = {
    method.__name__: method
    for method in (
        td,
        n_step_td,
        td_lambda,
        true_online_td_lambda,
        offline_lambda_return,
        monte_carlo,
        importance_sampling,
        batch_td,
    )
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
