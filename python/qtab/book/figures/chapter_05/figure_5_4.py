"""Figure 5.4: ordinary importance sampling with infinite variance."""

from functools import cache

import numpy as np

from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting, PredictionTask
from qtab.book.runner import FloatArray
from qtab.envs.tabular import TabularEnv
from qtab.planning.policy_values import PolicyValues, policy_values
from qtab.prediction.estimates import ValueEstimates

_EPISODES = 100_000_000
_POINTS = tuple(np.unique(np.geomspace(1, _EPISODES, 400).round().astype(int)).tolist())


@cache
def one_state() -> PredictionTask:
    """Returns Example 5.5: left stays with probability 0.9 or ends with reward 1, right ends without one."""
    left = [(0.9, 0, 0.0, False), (0.1, 0, 1.0, True)]
    env = TabularEnv([[left, [(1.0, 0, 0.0, True)]]], [1.0])
    return PredictionTask(env, [0], policy_values(env, [0]))


def estimates_of_state(estimates: ValueEstimates, true_values: PolicyValues) -> FloatArray:  # noqa: ARG001 - as others
    """Returns (runs, points): the estimated value of the state."""
    return estimates.weights[:, :, 0]


EXPERIMENT = PredictionExperiment(
    name="figure-5.4",
    title="ordinary importance sampling with infinite variance",
    book="Example 5.5: one state, left stays with probability 0.9 or ends with reward 1, right ends; the behavior "
    "policy takes both with equal probability, the target policy always left; first-visit; ten runs of 100,000,000 "
    "episodes; the true value is 1",
    unspecified="",
    settings=(
        PredictionSetting(
            "run",
            one_state,
            {
                "method": "importance_sampling",
                "weighted": False,
                "first_visit": True,
                "behavior": "random",
                "episodes": _EPISODES,
                "record": _POINTS,
            },
            estimates_of_state,
            _POINTS,
            each_run=True,
            named=False,
        ),
    ),
    runs=10,
    x_label="episodes",
    y_label="estimated value",
    table_x=tuple(min(_POINTS, key=lambda point: abs(point - 10**power)) for power in range(2, 9)),
    log_x=True,
    y_range=(0, 3),
)
