"""Twenty environments in compiled code: equal to Python to the last bit, whatever their parameters are."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.environments import own
from support.lockstep.twins import assert_equal_steps

pytest.importorskip("numba")

PROBABILITY = st.floats(0.0, 1.0)
PARAMETERS: dict[Any, dict[str, st.SearchStrategy[Any]]] = {
    own.AccessControl: {"free": PROBABILITY},
    own.CartPole: {"force": st.floats(-20.0, 20.0), "mass": st.floats(0.01, 2.0)},
    own.Epidemic: {"people": st.integers(100, 1000), "recovery": PROBABILITY},
    own.Inventory: {"demand": st.floats(0.0, 9.9), "prices": st.tuples(*[st.floats(-5.0, 5.0)] * 3)},
    own.KeyAndDoor: {"slip": PROBABILITY},
    own.MineField: {"mines": st.integers(1, 8)},
    own.MountainCar: {"force": st.floats(-0.01, 0.01), "gravity": st.floats(-0.01, 0.01)},
    own.NoisyPendulum: {"gravity": st.floats(-20.0, 20.0), "noise": st.floats(0.0, 3.0)},
    own.Queue: {"arrival": PROBABILITY, "service": PROBABILITY},
    own.Robot: {"cans": PROBABILITY, "drain": st.floats(0.001, 0.5)},
    own.SlipperyGrid: {"slip": PROBABILITY},
    own.Thermostat: {"gain": st.floats(-5.0, 5.0), "loss": st.floats(0.0, 1.0), "target": st.floats(-50.0, 50.0)},
    own.WindyGrid: {"random_wind": st.booleans()},
}
"""Parameters that change only numbers, so that no example needs another compilation."""


@pytest.mark.parametrize("made", own.ENVIRONMENTS, ids=lambda made: made.__name__)
@given(data=st.data())
def test_compiled_steps_equal_pythons(made: Any, data: st.DataObject) -> None:
    chosen = {name: data.draw(strategy, name) for name, strategy in PARAMETERS.get(made, {}).items()}
    seed, actions_seed = data.draw(st.integers(0, 2**64), "seed"), data.draw(st.integers(0, 2**32), "actions")
    assert_equal_steps(made(**chosen), seed, actions_seed, steps=data.draw(st.integers(1, 150), "steps"))


def test_there_are_twenty() -> None:
    assert len(set(own.ENVIRONMENTS)) >= 20
