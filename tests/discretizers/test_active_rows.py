"""Active rows of batches of observations equal those that training uses."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from qtab import _core
from qtab._spec import DiscretizerSpec
from qtab.reference.parts.observations import discretizer as numpy_discretizer
from qtab.training.setup.resolve import resolve

TILES = {"discretizer": "tiles", "tilings": 8, "tiles": (8, 8)}
SETTINGS: dict[str, tuple[str, dict[str, Any]]] = {
    "round": ("MountainCar-v0", {}),
    "bins": ("MountainCar-v0", {"discretizer": "bins", "bins": (7, 5), "scale": ()}),
    "edges": ("MountainCar-v0", {"discretizer": "edges", "edges": ((-1.0, 0.0), (0.0,)), "scale": ()}),
    "tiles": ("MountainCar-v0", {**TILES, "terminal_update": "target", "scale": ()}),
    "hashed": ("MountainCar-v0", {**TILES, "hashed_rows": 500, "terminal_update": "target", "scale": ()}),
    "Discrete": ("FrozenLake-v1", {}),
    "Tuple": ("Blackjack-v1", {}),
}


@pytest.mark.parametrize("name", SETTINGS)
def test_a_batch_has_the_rows_of_each_observation(name: str) -> None:
    env, settings = SETTINGS[name]
    resolved = resolve(env, {"seed": 0, **settings})
    discretizer = _core.Discretizer(resolved.discretizer.spec())
    reference = numpy_discretizer(gym.make(env), resolved.config)
    rng = np.random.default_rng(0)
    low, high = resolved.discretizer.low, resolved.discretizer.high
    if low.dtype.kind == "f":
        batch = rng.uniform(low, high, (200, *low.shape)).astype(low.dtype)
    else:
        batch = rng.integers(low, high + 1, (200, *low.shape))
    rows = discretizer.active_rows(batch)
    assert rows.dtype == np.int64
    assert rows.shape == (200, discretizer.n_active)
    assert rows.min() >= 0
    assert rows.max() < discretizer.n_rows == resolved.discretizer.n_rows
    for index, observation in enumerate(batch):
        assert discretizer.active_rows(observation).tolist() == rows[index].tolist()
        assert reference.rows(observation) == rows[index].tolist()


def test_every_numeric_dtype_is_converted_as_astype_does() -> None:
    spec: DiscretizerSpec = {"type": "bins", "dtype": "float32", "edges": [[0.1, 1.0, 2.0]]}
    discretizer = _core.Discretizer(spec)
    for dtype in ("float16", "float32", "float64", "int8", "int64", "uint64"):
        batch = np.arange(4).astype(dtype)[:, np.newaxis]
        assert discretizer.active_rows(batch).ravel().tolist() == [0, 2, 3, 3], dtype
    # A float64 observation is converted to the dtype of the space first.
    assert (
        discretizer.active_rows(np.array([0.1])).tolist()
        == discretizer.active_rows(np.array([0.1], np.float32)).tolist()
    )
    assert discretizer.active_rows([[0.5], [1.5]]).tolist() == [[1], [2]]
    assert discretizer.active_rows(np.full((2, 2), 0.5)[:, :1]).tolist() == [[1], [1]]


BOX: DiscretizerSpec = {
    "type": "round",
    "dtype": "float64",
    "low": [0.0, 0.0],
    "high": [1.0, 1.0],
    "scale": [10.0, 10.0],
}
DISCRETE: DiscretizerSpec = {"type": "identity", "first": [2], "counts": [3], "scalar": True}
PAIRS: DiscretizerSpec = {"type": "identity", "first": [0, 1], "counts": [3, 2], "scalar": False}


@pytest.mark.parametrize(
    ("spec", "observations", "error", "message"),
    [
        (BOX, [0.5], ValueError, r"^observation must have shape \(2,\), got \(1,\)$"),
        (BOX, [[0.5]], ValueError, r"^observations must have shape \(n, 2\), got \(1, 1\)$"),
        (BOX, [0.5, 2.0], ValueError, r"^observation\[1\] is 2, outside the observation space$"),
        (BOX, [0.5, np.nan], ValueError, r"^observation\[1\] is NaN, outside the observation space$"),
        (BOX, [[0.5, 0.5], [np.inf, 0.5]], ValueError, r"^observations\[1\]\[0\] is inf, outside the obs"),
        (BOX, ["a", "b"], TypeError, "^observation must hold numbers, got array"),
        (BOX, [True, False], TypeError, "^observation must hold numbers, got array"),
        (DISCRETE, 1, ValueError, r"^observation\[0\] is 1, outside the observation space$"),
        (DISCRETE, [2, 4, 5], ValueError, r"^observations\[2\]\[0\] is 5, outside the observation space$"),
        (DISCRETE, 2.0, TypeError, "^observation must hold integers, got array"),
        (DISCRETE, [[2]], ValueError, r"^observations must have shape \(\) or \(n,\), got \(1, 1\)$"),
        (DISCRETE, np.uint64(2**64 - 1), ValueError, "outside the observation space$"),
        (PAIRS, [0, 0], ValueError, r"^observation\[1\] is 0, outside the observation space$"),
    ],
)
def test_an_observation_without_rows_is_refused_with_its_index(
    spec: DiscretizerSpec, observations: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        _core.Discretizer(spec).active_rows(observations)
