"""Predictions are verified against their reference in NumPy where policies are given in unusual ways."""

from typing import Any

import numpy as np
import pytest

import qtab


@pytest.mark.parametrize("behavior", ["random", lambda observation: [1 / 3] * 3])
def test_a_policy_that_is_deterministic_up_to_rounding_is_verified(behavior: Any) -> None:
    policy = np.zeros((30, 3))
    policy[:, 1] = 1 - 5e-10
    settings: Any = {"discretizer": "bins", "bins": (5, 6), "max_episode_steps": 50}
    estimates = qtab.estimate_values(
        "MountainCar-v0", policy, behavior=behavior, method="importance_sampling", episodes=20, seeds=1, **settings
    )
    assert estimates.verify().equal
