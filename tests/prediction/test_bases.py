"""Values over the observations of a Box by weighted features: equal to plain NumPy for every method and basis."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.config.options import WEIGHTED as BASES
from support.learners.box_prediction import CAR, PENDULUM, POLE, with_the_velocity
from support.learners.weighted_prediction import WEIGHTED, options_of

LIMITS: dict[str, Any] = {"low": [-2.4, -3.0, -0.2, -3.0], "high": [2.4, 3.0, 0.2, 3.0]}
BOXES: dict[str, tuple[list[Any], dict[str, Any]]] = {
    CAR: (["random", with_the_velocity, lambda at: [0.7, 0.2, 0.1] if at[1] < 0 else [0.1, 0.2, 0.7]], {}),
    POLE: (["random", lambda at: int(at[2] + at[3] > 0)], LIMITS),
    PENDULUM: (["random", lambda at: 1], {"actions": 3}),
}
DIMENSIONS = {CAR: 2, POLE: 4, PENDULUM: 3}


def options_of_basis(basis: str, env: str, data: st.DataObject) -> dict[str, Any]:
    """Options of a basis with few features."""
    dimensions = DIMENSIONS[env]
    if basis in ("fourier", "polynomial"):
        return {"order": data.draw(st.integers(1, 3)), "coupled": env == CAR or data.draw(st.booleans())}
    fewest = 3 if basis == "coarse" and env == CAR else 2
    centers = [data.draw(st.integers(fewest, 3)) for _ in range(dimensions)]
    if basis == "radial":
        width = data.draw(st.floats(0.5, 2.0) | st.lists(st.floats(0.5, 2.0), min_size=dimensions, max_size=dimensions))
        return {"centers": centers, "width": width, "normalized": data.draw(st.booleans())}
    return {"centers": centers, "radius": data.draw(st.floats(1.0, 1.4))}


@pytest.mark.parametrize("basis", BASES)
@pytest.mark.parametrize("method", WEIGHTED)
@settings(max_examples=settings().max_examples // 10)
@given(data=st.data())
def test_every_method_with_every_basis_equals_plain_numpy(method: Any, basis: Any, data: st.DataObject) -> None:
    env = data.draw(st.sampled_from(list(BOXES)))
    policies, given = BOXES[env]
    options = {**given, **options_of(method, data), **options_of_basis(basis, env, data)}
    if basis == "fourier" and method != "lstd":
        options["scale_step_sizes"] = data.draw(st.booleans())
    found = qtab.estimate_values(
        env,
        data.draw(st.sampled_from(policies)),
        method=method,
        discretizer=basis,
        episodes=2,
        discount=data.draw(st.sampled_from([0.0, 0.9])),
        max_episode_steps=data.draw(st.sampled_from([5, 40])),
        on_truncation=data.draw(st.sampled_from(["bootstrap", "terminate"])),
        seeds=[data.draw(st.integers(0, 1000))],
        **options,
    )
    assert found.verify().equal


TRAINED: dict[str, dict[str, Any]] = {
    "fourier": {"order": 2, "algorithm": "double_q_learning"},
    "polynomial": {"order": 3, "coupled": False},
    "radial": {"centers": (9, 8), "normalized": True, "algorithm": "actor_critic"},
    "coarse": {"centers": 4, "algorithm": "sarsa"},
}
DIVISIONS: dict[str, dict[str, Any]] = {
    "as in the run": {},
    "other features": {"discretizer": "radial", "centers": 3},
    "tiles": {"discretizer": "tiles", "tilings": 4},
    "bins": {"discretizer": "bins", "bins": 4},
}


@pytest.mark.parametrize("basis", TRAINED)
def test_a_run_with_weighted_features_is_followed_as_a_function_would_be(basis: Any) -> None:
    given: dict[str, Any] = {"learning_rate": 0.01, "episodes": 3, "max_episode_steps": 60}
    run = qtab.train(CAR, discretizer=basis, seed=12, initial_q=(-0.5, 0.5), **{**given, **TRAINED[basis]})
    taken = set()

    def as_a_function(observation: Any) -> int:
        action = int(run.predict(observation)[0])
        taken.add(action)
        return action

    for name, division in DIVISIONS.items():
        followed = qtab.estimate_values(CAR, run, seeds=2, **given, **division)
        called = qtab.estimate_values(
            CAR, as_a_function, seeds=2, **given, **(division or {"discretizer": basis, **_options(run)})
        )
        assert followed.weights.tobytes() == called.weights.tobytes(), name
        assert followed.verify().equal, name
    assert len(taken) > 1


def _options(run: qtab.Run) -> dict[str, Any]:
    """The options of the discretizer of a run."""
    names = ("order", "coupled", "scale_step_sizes", "centers", "width", "normalized", "radius")
    return {name: getattr(run.config, name) for name in names if getattr(run.config, name) is not None}


def test_a_run_with_weighted_features_can_act_while_another_policy_is_evaluated() -> None:
    run = qtab.train(CAR, discretizer="fourier", order=2, seed=0, episodes=3, initial_q=(-0.5, 0.5))
    found = qtab.estimate_values(
        CAR,
        run,
        behavior="random",
        method="tdc",
        learning_rate=0.005,
        second_learning_rate=0.01,
        episodes=3,
        max_episode_steps=60,
    )
    assert found.verify().equal
    with pytest.raises(ValueError, match="behavior must cover policy"):
        qtab.estimate_values(CAR, "random", behavior=run, method="off_policy_td", learning_rate=0.01)


def test_lstd_has_no_step_sizes_to_scale_with_the_features_of_a_run() -> None:
    run = qtab.train(CAR, discretizer="fourier", order=2, seed=0, episodes=1)
    found = qtab.estimate_values(CAR, run, method="lstd", episodes=2, max_episode_steps=60)
    assert found.verify().equal
    with pytest.raises(ValueError, match="scale_step_sizes must be False for method 'lstd'"):
        qtab.estimate_values(CAR, run, method="lstd", scale_step_sizes=True, order=2, discretizer="fourier")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"discretizer": "polynomial", "scale_step_sizes": True}, "scale_step_sizes applies to discretizer 'fourier'"),
        ({"discretizer": "fourier", "centers": 3}, "centers applies to discretizer 'radial' or 'coarse'"),
        ({"discretizer": "coarse", "width": 1.0}, "width applies to discretizer 'radial'"),
        ({"discretizer": "radial", "centers": 40}, "centers must give at most 1,024 features"),
        ({"discretizer": "coarse", "radius": 0.5}, "radius must be large enough"),
        ({"discretizer": "radial", "features": np.ones((25, 2))}, "features must be None for discretizer 'radial'"),
        ({"discretizer": "radial", "learning_rate": None}, "learning_rate must be given for features with values"),
    ],
)
def test_options_that_do_not_fit_are_refused_by_name(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        qtab.estimate_values(CAR, "random", **{"learning_rate": 0.1, **arguments})
