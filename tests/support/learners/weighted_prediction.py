"""Settings of predictions with features that have values other than 1."""

from typing import Any

from hypothesis import strategies as st

from qtab.prediction import METHODS
from qtab.prediction.learning_rates import AVERAGES_ONLY
from qtab.prediction.settings import OFF_POLICY

WEIGHTED: list[Any] = [method for method in METHODS if method not in AVERAGES_ONLY]


def options_of(method: str, data: st.DataObject, behavior: Any = "random") -> dict[str, Any]:
    """Options of a method, with step sizes that are small enough for features up to 1."""
    options: dict[str, Any] = {}
    if method == "lstd":
        options["epsilon"] = data.draw(st.floats(1e-3, 2.0))
        options["recursive"] = data.draw(st.booleans())
    else:
        options["learning_rate"] = data.draw(st.floats(0.0, 1e-4 if method == "emphatic_td" else 0.02))
        if data.draw(st.booleans()):
            options["learning_rate_schedule"] = "linear"
    if method in ("gtd2", "tdc"):
        options["second_learning_rate"] = data.draw(st.floats(0.0, 0.02))
    if "lambda" in method or method == "lstd":
        options["trace_decay"] = data.draw(st.floats(0.0, 1.0))
    if method == "n_step_td":
        options["n_steps"] = data.draw(st.integers(1, 30) | st.just(2000))
    if method in OFF_POLICY:
        options["behavior"] = behavior
    return options
