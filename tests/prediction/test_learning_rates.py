"""Learning rates of predictions that fall: equal to plain NumPy to the bit, stored, and what is refused."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab
from qtab.prediction import tile_coding

WALK = "qtab/RandomWalk-v0"
OPTIONS: dict[str, dict[str, Any]] = {
    "td": {},
    "n_step_td": {"n_steps": 2},
    "td_lambda": {"trace_decay": 0.8},
    "true_online_td_lambda": {"trace_decay": 0.8},
    "offline_lambda_return": {"trace_decay": 0.8},
    "monte_carlo": {},
}


def schedules(method: str, learning_rate: float | None) -> st.SearchStrategy[dict[str, Any]]:
    """A schedule of the learning rate of a run of four episodes, with some of its options."""
    visits: dict[str, Any] = {"learning_rate_schedule": st.just("visits")}
    low = st.floats(0.0, 1.0 if learning_rate is None else learning_rate)
    if learning_rate is None:
        return st.fixed_dictionaries(visits, optional={"min_learning_rate": low})
    warm_up = st.integers(0, 3)
    linear = st.fixed_dictionaries(
        {"learning_rate_schedule": st.just("linear")},
        optional={"min_learning_rate": low, "learning_rate_warm_up": warm_up},
    )
    exponential = st.fixed_dictionaries(
        {"learning_rate_schedule": st.just("exponential"), "learning_rate_decay": st.floats(0.0, 1.0)},
        optional={"min_learning_rate": low, "learning_rate_warm_up": warm_up},
    )
    by_visits = st.fixed_dictionaries(visits, optional={"min_learning_rate": low})
    with_traces = method in ("td_lambda", "true_online_td_lambda")
    return linear | exponential if with_traces else linear | exponential | by_visits


@given(data=st.data())
def test_any_schedule_equals_plain_numpy(data: st.DataObject) -> None:
    method: Any = data.draw(st.sampled_from(list(OPTIONS)))
    traces = method in ("td_lambda", "true_online_td_lambda")
    learning_rate = data.draw(st.floats(0.0, 1.0) if traces else st.none() | st.floats(0.0, 1.0))
    found = qtab.estimate_values(
        WALK,
        "random",
        method=method,
        episodes=4,
        env_kwargs={"states": 7},
        max_episode_steps=100,
        learning_rate=learning_rate,
        features=data.draw(st.sampled_from([None, tile_coding(7, 5, 3, 2)])),
        seeds=[data.draw(st.integers(0, 1000))],
        **OPTIONS[method],
        **data.draw(schedules(method, learning_rate)),
    )
    assert found.verify().equal


def test_a_schedule_is_saved_only_where_there_is_one(tmp_path: Any) -> None:
    path = tmp_path / "values.npz"
    falling = qtab.estimate_values(WALK, "random", learning_rate=0.5, learning_rate_schedule="linear", episodes=3)
    falling.save(path)
    assert qtab.ValueEstimates.load(path).settings == falling.settings
    assert falling.settings.learning_rate_warm_up == 0
    qtab.estimate_values(WALK, "random", learning_rate=0.5, episodes=3).save(path)
    with np.load(path) as arrays:
        assert "learning_rate_schedule" not in str(arrays["about"])


@pytest.mark.parametrize(
    "given",
    [
        {"learning_rate": 0.5},
        {"learning_rate": 0.5, "min_learning_rate": 0.1},
        {"learning_rate": 0.5, "learning_rate_warm_up": 3},
        {"learning_rate": 0.5, "min_learning_rate": 0.1, "learning_rate_schedule": "exponential"},
        {"learning_rate": 0.5, "min_learning_rate": 0.1, "learning_rate_schedule": "visits"},
    ],
)
def test_training_and_prediction_give_a_learning_rate_the_same_schedule(given: dict[str, Any], tmp_path: Any) -> None:
    found = qtab.estimate_values(WALK, "random", episodes=9, **given)
    trained = qtab.train("FrozenLake-v1", seed=0, episodes=9, **given).config
    settings = found.settings
    assert (settings.learning_rate_schedule or "constant") == trained.learning_rate_schedule
    for name in ("min_learning_rate", "learning_rate_warm_up", "learning_rate_decay"):
        assert getattr(settings, name) == getattr(trained, name), name
    assert found.verify().equal
    path = tmp_path / "values.npz"
    found.save(path)
    assert qtab.ValueEstimates.load(path).settings == settings


def test_a_minimum_without_a_learning_rate_limits_that_of_the_visits() -> None:
    found = qtab.estimate_values(WALK, "random", episodes=9, min_learning_rate=0.1)
    by_visits: dict[str, Any] = {"learning_rate_schedule": "visits", "min_learning_rate": 0.1}
    np.testing.assert_array_equal(
        found.weights, qtab.estimate_values(WALK, "random", episodes=9, **by_visits).weights, strict=True
    )


def test_a_falling_learning_rate_ends_nearer_to_the_values() -> None:
    exact = qtab.policy_values(WALK, "random")
    options: dict[str, Any] = {"learning_rate": 0.5, "episodes": 1000, "record": 1000, "seeds": 20}
    constant = qtab.estimate_values(WALK, "random", **options)
    falling = qtab.estimate_values(WALK, "random", **options, learning_rate_schedule="linear")
    assert falling.rms_error(exact).mean() < 0.5 * constant.rms_error(exact).mean()


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        (
            {"method": "td_lambda", "trace_decay": 0.5, "learning_rate": 0.1, "learning_rate_schedule": "visits"},
            ValueError,
            "learning_rate_schedule must be 'constant', 'linear' or 'exponential' for method 'td_lambda', got 'visits'",
        ),
        (
            {"learning_rate_schedule": "linear"},
            ValueError,
            "learning_rate must be given for learning_rate_schedule 'linear', got None",
        ),
        (
            {"learning_rate": 0.1, "learning_rate_schedule": "constant", "min_learning_rate": 0.05},
            ValueError,
            "min_learning_rate applies to learning_rate_schedule .*, not to 'constant', got 0.05",
        ),
        (
            {"learning_rate": 0.1, "learning_rate_decay": 0.9},
            ValueError,
            "learning_rate_decay applies to learning_rate_schedule 'exponential', not to 'constant', got 0.9",
        ),
        (
            {"learning_rate_warm_up": 5},
            ValueError,
            "learning_rate_warm_up applies to learning_rate_schedule .*, not to 'visits', got 5",
        ),
        (
            {"learning_rate": 0.1, "learning_rate_schedule": "linear", "min_learning_rate": 0.2},
            ValueError,
            r"min_learning_rate must lie in \[0, 0.1\], got 0.2",
        ),
        (
            {"learning_rate": 0.1, "learning_rate_schedule": "linear", "learning_rate_warm_up": 100},
            ValueError,
            "learning_rate_warm_up must be an integer from 0 to 99, got 100",
        ),
        (
            {"method": "batch_td", "learning_rate_schedule": "visits"},
            ValueError,
            "learning_rate_schedule must be None for method 'batch_td'",
        ),
    ],
)
def test_what_does_not_fit_is_refused_by_name(changes: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        qtab.estimate_values(WALK, "random", **changes)
