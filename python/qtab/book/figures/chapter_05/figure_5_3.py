"""Figure 5.3: ordinary and weighted importance sampling of one blackjack state."""

import numpy as np

from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import STATE, index_of, single_state
from qtab.book.runner import FloatArray
from qtab.planning.policy_values import PolicyValues
from qtab.prediction.estimates import ValueEstimates

_EPISODES = 10_000
_POINTS = tuple(np.unique(np.geomspace(1, _EPISODES, 60).round().astype(int)).tolist())
_STATE = index_of(STATE)


def squared_error(estimates: ValueEstimates, true_values: PolicyValues) -> FloatArray:
    """Returns (runs, points): the squared error of the value of the state in which episodes begin."""
    errors: FloatArray = (estimates.weights[:, :, _STATE] - true_values.values[_STATE]) ** 2
    return errors


EXPERIMENT = PredictionExperiment(
    name="figure-5.3",
    title="ordinary and weighted importance sampling",
    book="episodes begin in one blackjack state (13 with a usable ace against a two) and hit or stick at random; the "
    "target policy sticks on 20 and 21; true value -0.27726; 100 runs of 10,000 episodes",
    unspecified="whether first-visit or every-visit (no episode visits the state twice)",
    settings=tuple(
        PredictionSetting(
            f"{name} importance sampling",
            single_state,
            {
                "method": "importance_sampling",
                "weighted": weighted,
                "behavior": "random",
                "episodes": _EPISODES,
                "record": _POINTS,
            },
            squared_error,
            _POINTS,
        )
        for name, weighted in (("ordinary", False), ("weighted", True))
    ),
    runs=100,
    x_label="episodes",
    y_label="mean squared error",
    table_x=tuple(min(_POINTS, key=lambda point: abs(point - wanted)) for wanted in (1, 10, 100, 1_000, 10_000)),
    log_x=True,
    y_range=(0, 5),
)
