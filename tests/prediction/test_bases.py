"""Values over the observations of a Box by weighted features: equal to plain NumPy for every method and basis."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab
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


@given(data=st.data())
def test_any_method_with_any_basis_equals_plain_numpy(data: st.DataObject) -> None:
    method: Any = data.draw(st.sampled_from(WEIGHTED))
    basis: Any = data.draw(st.sampled_from(["fourier", "polynomial", "radial", "coarse"]))
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
