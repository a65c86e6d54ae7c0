"""Bins give the rows of Gymnasium's DiscretizeObservation where it works, and of np.digitize everywhere."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import DiscretizeObservation
from hypothesis import given
from hypothesis import strategies as st

import qtab
from qtab.reference.parts.discretizers import Bins
from support.environments import ScriptedEnv
from support.parity import run_of

DTYPES = [np.float32, np.float64]
CART_POLE: dict[str, Any] = {"low": (-2.4, -3.0, -0.21, -3.5), "high": (2.4, 3.0, 0.21, 3.5)}


def row_of_training(observation: Any, low: Any, high: Any, **chosen: Any) -> tuple[int, qtab.Run, gym.Env]:
    """The only row of a table of zeros that one step from one observation can change, and the run."""
    dtype = observation.dtype.type
    env = ScriptedEnv(
        [observation], low, high, dtype, actions=gym.spaces.Discrete(1), length=1, dimensions=len(observation)
    )
    run = qtab.train(env, episodes=1, seed=0, initial_q=0.0, **chosen)
    (row,) = np.flatnonzero(run.tables[0, :, 0])
    return int(row), run, env


@st.composite
def boxes(draw: st.DrawFn) -> tuple[Any, ...]:
    dtype = draw(st.sampled_from(DTYPES))
    dimensions = draw(st.integers(1, 3))
    low = np.array([draw(st.floats(-100, 100)) for _ in range(dimensions)], dtype)
    high = np.array([edge + draw(st.floats(1e-3, 100)) for edge in low], dtype)
    bins = tuple(draw(st.integers(1, 12)) for _ in range(dimensions))
    return low, high, bins


@given(box=boxes(), data=st.data())
def test_rows_equal_gymnasiums_discretize_observation(box: tuple[Any, ...], data: st.DataObject) -> None:
    low, high, bins = box
    edges = [np.linspace(*ends) for ends in zip(low, high, np.array(bins) + 1, strict=True)]
    # Edges, their neighbours, and anything else in the box.
    shown = [
        data.draw(st.sampled_from([*row, *np.nextafter(row, low[axis]), *np.nextafter(row, high[axis])]))
        if data.draw(st.booleans())
        else low.dtype.type(data.draw(st.floats(0, 1))) * (high[axis] - low[axis]) + low[axis]
        for axis, row in enumerate(edges)
    ]
    observation = np.clip(np.array(shown, low.dtype), low, high)
    row, run, env = row_of_training(observation, low, high, discretizer="bins", bins=bins)
    assert row == DiscretizeObservation(env, bins).observation(observation)
    assert run.discretizer.active_rows(observation).tolist() == [row]
    space: Any = env.observation_space
    assert Bins(space, run.config).rows(observation) == [row]
    assert run.q_table.shape == (*bins, 1)
    assert qtab.verify(run, env=env).equal


@given(
    edges=st.lists(st.floats(-1e300, 1e300), unique=True, max_size=90).map(sorted),
    value=st.floats(allow_nan=False),
    dtype=st.sampled_from(DTYPES),
    data=st.data(),
)
def test_given_edges_equal_np_digitize(edges: list[float], value: float, dtype: Any, data: st.DataObject) -> None:
    pick: Any = data.draw
    if edges and pick(st.booleans()):
        value = data.draw(st.sampled_from(edges))
    with np.errstate(over="ignore"):
        observation = np.array([value], dtype)
    row, run, env = row_of_training(observation, -np.inf, np.inf, discretizer="edges", edges=(edges,))
    assert row == np.digitize(observation[0], edges)
    assert run.discretizer.active_rows(observation).tolist() == [row]
    assert run.config.edges == (tuple(edges),)
    assert qtab.verify(run, env=env).equal


def test_training_with_the_wrapper_gives_the_same_table() -> None:
    bins = (12, 9)
    ours = qtab.train("MountainCar-v0", seed=3, episodes=50, discretizer="bins", bins=bins)
    wrapped = DiscretizeObservation(gym.make("MountainCar-v0"), bins)
    theirs = qtab.train(wrapped, seed=3, episodes=50, terminal_update="assign")
    assert theirs.config.discretizer == "identity"
    assert ours.tables.tobytes() == theirs.tables.tobytes()


@pytest.mark.parametrize("dtype", DTYPES)
def test_a_box_narrower_than_the_wrappers_margin_has_all_bins(dtype: Any) -> None:
    low, high = 0.0, 1e-9
    rows = [
        row_of_training(np.array([part * high], dtype), low, high, discretizer="bins", bins=4)[0]
        for part in (0.1, 0.3, 0.6, 0.9)
    ]
    assert rows == [0, 1, 2, 3]


def test_observations_beyond_the_limits_belong_to_the_outermost_bins() -> None:
    for value, row in ((-np.inf, 0), (-5.0, 0), (5.0, 3), (np.inf, 3)):
        observation = np.array([value], np.float32)
        assert row_of_training(observation, -1.0, 1.0, discretizer="bins", bins=4)[0] == row


def test_limits_are_given_for_all_components_or_none() -> None:
    with pytest.raises(ValueError, match=r"^low must be given, a number for each component, .*no finite bounds"):
        qtab.train("CartPole-v1", discretizer="bins", bins=3, low=None, high=None)
    with pytest.raises(ValueError, match=r"^low must hold 4 numbers for this observation space, got \(-2.4,\)"):
        qtab.train("CartPole-v1", discretizer="bins", low=(-2.4,), high=(2.4,))
    run = qtab.train("CartPole-v1", discretizer="bins", bins=3, episodes=2, seed=0, **CART_POLE)
    assert (run.config.bins, run.config.low) == ((3, 3, 3, 3), CART_POLE["low"])


@pytest.mark.parametrize(
    ("chosen", "error"),
    [
        ({"bins": 0}, r"^bins must be an integer from 1 to 1000000, got 0"),
        ({"bins": ()}, r"^bins must hold a number for each component"),
        ({"bins": 2.5}, r"^bins must be an integer"),
        ({"bins": (3, 3, 3)}, r"^bins must hold 2 numbers for this observation space, or one, got \(3, 3, 3\)"),
        ({"bins": (1_000_000, 1_000_000)}, r"^bins must give a table of fewer than 2\*\*32 values, got "),
        ({"low": (0.0, 0.0), "high": (1.0, 0.0)}, r"^high must lie above low"),
        ({"low": (float("nan"), 0.0)}, r"^low must be finite, got nan"),
        ({"low": (None, 0.0)}, r"^low must be a finite number, got None"),
        ({"low": (-1e39, 0.0), "high": (1e39, 1.0)}, r"^high - low must be finite in float32, got low="),
        ({"edges": ((0.0,), (0.0,))}, r"^edges applies to discretizer 'edges', not to 'bins'"),
        ({"tiles": 4}, r"^tiles applies to discretizer 'tiles', not to 'bins'"),
        ({"discretizer": "edges"}, r"^edges must hold 2 rows of numbers for this observation space, got None"),
        ({"discretizer": "edges", "edges": ((0.0,),)}, r"^edges must hold 2 rows of numbers"),
        ({"discretizer": "edges", "edges": ((0.0, 0.0), ())}, r"^edges must hold rows of ascending numbers, got "),
        ({"discretizer": "edges", "edges": ((1.0, 0.0), ())}, r"^edges must hold rows of ascending numbers, got "),
        ({"discretizer": "edges", "edges": ((float("inf"),), ())}, r"^edges must be finite, got inf"),
        ({"discretizer": "edges", "edges": (0.0, 1.0)}, r"^edges must hold a number for each"),
        ({"discretizer": "edges", "edges": 3}, r"^edges must hold a row of numbers for each component"),
        (
            {"discretizer": "edges", "edges": ((), ()), "low": (0, 0)},
            r"^low applies to discretizer 'bins', 'tiles', 'fourier',",
        ),
    ],
    ids=str,
)
def test_settings_that_do_not_fit_are_refused(chosen: dict[str, Any], error: str) -> None:
    with pytest.raises((TypeError, ValueError), match=error):
        qtab.train("MountainCar-v0", **{"discretizer": "bins", **chosen})


def test_nan_in_an_observation_is_refused_with_its_index() -> None:
    good, bad = np.zeros(2, np.float32), np.array([0.0, np.nan], np.float32)
    env = ScriptedEnv([good, good, bad], low=-1.0, high=1.0, dimensions=2)
    with pytest.raises(ValueError, match=r"observation\[1\] is NaN, outside the observation space") as caught:
        qtab.train(env, discretizer="bins", bins=3, seed=0)
    assert run_of(caught.value).completed is False


@pytest.mark.slow
@pytest.mark.parametrize(
    "chosen",
    [
        {"discretizer": "bins", "bins": (9, 7)},
        {"discretizer": "edges", "edges": ((-0.5, 0.1, 0.3), (-0.01, 0.0, 0.01))},
    ],
    ids=str,
)
def test_a_run_is_saved_loaded_evaluated_and_verified(chosen: dict[str, Any], tmp_path: Any) -> None:
    run = qtab.train("MountainCar-v0", seed=1, episodes=8, **chosen)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert vars(loaded.config) == vars(run.config)
    assert loaded.q_table.tobytes() == run.q_table.tobytes()
    assert loaded.policy.tolist() == run.policy.tolist()
    for position, velocity in np.random.default_rng(0).uniform((-1.2, -0.07), (0.6, 0.07), (50, 2)):
        observation = np.array([position, velocity], np.float32)
        cell = run.discretizer.cell(observation)
        assert loaded.predict(observation) == run.predict(observation) == (run.policy[cell], None)
        assert run.q_values(observation).tobytes() == run.q_table[cell].tobytes()
    assert qtab.verify(loaded).equal
    played = qtab.evaluate(run, episodes=3, seed=1)
    assert played.returns.tobytes() == qtab.evaluate(loaded, episodes=3, seed=1).returns.tobytes()


def test_a_sweep_accepts_bins_and_edges() -> None:
    table = qtab.sweep("MountainCar-v0", {"bins": [4, (6, 8)]}, seeds=2, episodes=5, discretizer="bins")
    assert len(table.columns["seed"]) == 4
    rows = [((0.0,), ()), ((), (0.0,))]
    table = qtab.sweep("MountainCar-v0", {"edges": rows}, seeds=2, episodes=5, discretizer="edges")
    assert len(table.columns["seed"]) == 4


def test_discrete_observations_refuse_bins() -> None:
    with pytest.raises(ValueError, match=r"got Discrete\(500\); discretizer must be left out for it$"):
        qtab.train("Taxi-v4", discretizer="bins")
