"""Training on observations of any space: nested, mixed, of every dtype, and those that are refused."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.spaces import Box, Dict, Discrete, MultiBinary, MultiDiscrete, Tuple
from gymnasium.vector.utils import concatenate, create_empty_array
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.discretizers.identity import Identity
from qtab.reference.parts.observations import discretizer as numpy_discretizer
from support.environments import Sampled
from support.environments.gridworld import Tutorial
from support.parity import assert_same_run

SETTINGS: dict[str, Any] = {"episodes": 3, "seed": 5, "epsilon": 0.5, "learning_rate": 0.3, "max_episode_steps": 20}
DEFAULT: Any = settings.default
EXAMPLES = max(DEFAULT.max_examples // 4, 1)
SHAPES = st.sampled_from([(), (1,), (2,), (1, 2)])


@st.composite
def leaves(draw: st.DrawFn, unbounded: bool) -> gym.Space[Any]:
    """A space without spaces in it, of few values a component."""
    kind = draw(st.integers(0, 6))
    shape, count = draw(SHAPES), draw(st.integers(1, 4))
    if kind == 0:
        return Discrete(count, start=draw(st.sampled_from([0, -3, 2**60])))
    if kind == 1:
        nvec = np.array(draw(st.sampled_from([[2, 3], [[1], [4]]])))
        return MultiDiscrete(nvec, start=nvec - 3)
    if kind == 2:
        size: Any = draw(st.sampled_from([2, (1, 2)]))
        return MultiBinary(size)
    if kind == 3:
        dtype: Any = draw(st.sampled_from([np.int8, np.int64, np.uint16]))
        return Box(1, 1 + count, shape, dtype)
    if kind == 4:
        high: Any = np.inf if unbounded else 5000
        return Box(-7, high, shape, np.int64)
    if kind == 5:
        return Box(0, 1, shape, np.bool_)
    return Box(-1.5, 2.0, shape, draw(st.sampled_from([np.float16, np.float32, np.float64])))


def nested(unbounded: bool) -> st.SearchStrategy[gym.Space[Any]]:
    """A leaf, or a Dict or Tuple of a few, which can be nested once more."""
    leaf = leaves(unbounded)
    keys = st.sampled_from(["b", "a", "right"])
    inner = leaf | st.lists(leaf, min_size=1, max_size=2).map(Tuple)
    dicts = st.dictionaries(keys, inner, min_size=1, max_size=2).map(Dict)
    return leaf | dicts | st.tuples(leaf, dicts | leaf).map(Tuple)


@st.composite
def cases(draw: st.DrawFn) -> tuple[gym.Space[Any], dict[str, Any]]:
    """A space and settings that serve it."""
    max_rows = draw(st.none() | st.just(100))
    space = draw(nested(unbounded=max_rows is not None))
    name = draw(st.sampled_from(["bins", "tiles"])) if max_rows is None else "bins"
    options: Any = {"bins": {"bins": 3}, "tiles": {"tilings": 3, "tiles": 2, "learning_rate": 0.2}}[name]
    chosen: dict[str, Any] = {**SETTINGS, "discretizer": name, **options}
    floats = any(np.issubdtype(part.dtype, np.floating) for part in boxes(space))
    large = any(np.issubdtype(part.dtype, np.integer) and part.high.max() > 1024 for part in boxes(space))
    if not floats and (max_rows is not None or not large):
        chosen = dict(SETTINGS)  # nothing needs to be divided
    if max_rows is not None:
        chosen["max_rows"] = max_rows
    chosen["algorithm"] = draw(st.sampled_from(["q_learning", "sarsa_lambda", "double_q_learning"]))
    return space, chosen


def boxes(space: Any) -> list[Box]:
    if isinstance(space, Dict | Tuple):
        parts = space.spaces.values() if isinstance(space, Dict) else space.spaces
        return [box for part in parts for box in boxes(part)]
    return [space] if isinstance(space, Box) else []


@settings(max_examples=EXAMPLES)
@given(cases())
def test_any_nesting_of_spaces_trains_verifies_predicts_and_is_saved(
    case: tuple[gym.Space[Any], dict[str, Any]],
) -> None:
    space, chosen = case
    run = qtab.train(Sampled(space), **chosen)
    assert qtab.verify(run, env=Sampled(space)).equal
    with TemporaryDirectory() as folder:
        run.save(Path(folder) / "run.npz")
        loaded = qtab.load(Path(folder) / "run.npz")
    assert_same_run(run, loaded)
    assert loaded.config == run.config
    reference = numpy_discretizer(Sampled(space), run.config)
    space.seed(7)
    observations = [space.sample() for _ in range(4)]
    rows = [run.discretizer.active_rows(observation) for observation in observations]
    if run.config.max_rows is None:
        assert [list(row) for row in rows] == [reference.rows(observation) for observation in observations]
    for observation, row in zip(observations, rows, strict=True):
        values = sum(table[row].sum(axis=0) for table in run.tables)
        assert np.allclose(run.q_values(observation), values, atol=1e-12)
        assert loaded.predict(observation)[0] == run.predict(observation)[0] == np.argmax(run.q_values(observation)) + 2
    empty: Any = create_empty_array(space, 4)
    plain = isinstance(space, Tuple) and isinstance(run.discretizer, Identity)
    batch = np.array(observations) if plain else concatenate(space, observations, empty)
    assert np.array_equal(run.discretizer.active_rows(batch), np.stack(rows))


def test_the_order_is_gymnasiums_and_each_component_has_an_axis() -> None:
    parts: Any = [Box(0, 2, (2,), np.int8), Box(0.0, 1.0, ())]
    space = Dict({"z": Discrete(2), "a": Tuple(parts)})
    run = qtab.train(Sampled(space), discretizer="bins", bins=5, **SETTINGS)
    assert [axis.name for axis in run.axes] == ["a[0][0]", "a[0][1]", "a[1]", "z"]
    assert run.q_table.shape == (3, 3, 5, 2, 3)
    observation = {"z": 1, "a": (np.array([2, 0], np.int8), np.array(0.5, np.float32))}
    assert run.discretizer.cell(observation) == (2, 0, 2, 1)
    assert np.array_equal(run.q_values(observation), run.q_table[2, 0, 2, 1])
    assert run.discretizer.cell(np.array([2, 0, 0.5, 1])) == (2, 0, 2, 1)
    assert run.discretizer.cell(np.array([1.6, -0.4, 0.5, 1.2])) == (2, 0, 2, 1)  # coordinates within the same edges


@pytest.mark.slow
def test_the_values_of_a_mixed_space_are_drawn_also_with_tiles() -> None:
    pytest.importorskip("matplotlib")
    space = Dict({"room": Discrete(3), "speed": Box(-1.0, 1.0, (1,))})
    run = qtab.train(Sampled(space), discretizer="tiles", **SETTINGS)
    ax = qtab.plots.values(run)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("room", "speed[0]")


def test_each_key_has_its_discretizer_in_every_use_of_the_run(tmp_path: Path) -> None:
    parts: Any = {
        "room": Discrete(3),
        "speed": Box(-1.0, 1.0, (2,)),
        "heat": Box(0.0, 9.0, ()),
        "far": Box(0, 10**6, ()),
    }
    env = Sampled(Dict(parts))
    chosen: Any = {"speed": "bins", "heat": {"discretizer": "edges", "edges": [[1, 5]]}, "far": "identity"}
    with pytest.raises(ValueError, match=r"discretizer\['far'\] must be 'bins', 'tiles' or another one for floats"):
        qtab.train(env, discretizer=chosen, **SETTINGS)
    chosen["far"] = {"discretizer": "tiles", "tiles": 4, "high": [100]}
    run = qtab.train(env, discretizer=chosen, **SETTINGS)
    assert run.config.discretizer == {
        "speed": {"discretizer": "bins", "bins": (10, 10), "low": (-1.0, -1.0), "high": (1.0, 1.0)},
        "heat": {"discretizer": "edges", "edges": ((1.0, 5.0),)},
        "far": {"discretizer": "tiles", "tilings": 8, "tiles": (4,), "low": (0.0,), "high": (100.0,)},
    }
    assert run.tables.shape == (1, 3 * 10 * 10 * 3 * 8 * 5, 3)
    assert qtab.verify(run, env=env).equal
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.config == run.config
    assert hash(loaded.config) == hash(run.config)
    observation = env.observation_space.sample()
    assert loaded.discretizer.active_rows(observation).tolist() == run.discretizer.active_rows(observation).tolist()
    assert qtab.evaluate(loaded, episodes=2, seed=1, env=env).lengths.sum() > 0
    assert len(qtab.resume(loaded, 5, env=env).episode_returns) == 5
    assert_same_run(qtab.train(env, config=loaded.config), run)


@pytest.mark.parametrize(
    ("space", "discretizer", "text"),
    [
        (Dict(a=Box(-1, 1, (1,))), {"b": "bins"}, r"discretizer\['b'\] does not fit .* keys: 'a'"),
        (Dict(a=Box(-1, 1, (1,)), b=Box(-1, 1, (1,))), {"b": "bins"}, "discretizer must have a value for 'a' as well"),
        (Dict(a=Box(-1, 1, (1,)), b=Box(-1, 1, (1,))), {"a": "tiles", "b": "tiles"}, "'tiles' for one key at most"),
        (Dict(a=Discrete(3)), {"a": "bins"}, r"discretizer\['a'\] must be 'identity' or left out"),
        (Dict(a=Box(-1, 1, (1,))), {"a": "identity"}, r"discretizer\['a'\] must be 'bins', 'tiles' or another"),
        (Dict(a=Box(-1, 1, (1,))), {"a": {"discretizer": "bins", "tiles": 3}}, r"discretizer\['a'\]: tiles applies to"),
        (Dict(a=Box(-1, 1, (1,))), {"a": {"discretizer": "bins", "bin": 3}}, r"unknown option 'bin' \(did you mean"),
        (
            Dict(a=Box(-1, 1, (1,))),
            {"a": {"discretizer": "bins", "low": (1, 2)}},
            r"discretizer\['a'\]: low must hold 1",
        ),
        (
            Box(-1, 1, (1,)),
            {"a": "bins"},
            "discretizer must be a name or a function for an observation space without keys",
        ),
        (Discrete(3), {}, "discretizer must name a discretizer for at least one key"),
    ],
    ids=str,
)
def test_a_mapping_that_does_not_fit_is_refused(space: gym.Space[Any], discretizer: Any, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        qtab.train(Sampled(space), discretizer=discretizer, **SETTINGS)


@pytest.mark.parametrize(
    ("discretizer", "error", "text"),
    [
        ({0: "bins"}, ValueError, r"discretizer must be a name or a function for an .*, got \{'0': \{"),
        ({"position": {"bins": 3}}, TypeError, r"discretizer\['position'\] must be a name, or a mapping of"),
        ({"position": 5}, TypeError, r"discretizer\['position'\] must be a name, or a mapping of .*, got 5$"),
    ],
    ids=str,
)
def test_a_mapping_is_checked_before_a_preset_is_fitted_to_it(
    discretizer: Any, error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text):
        qtab.train("MountainCar-v0", discretizer=discretizer, **SETTINGS)


@pytest.mark.parametrize(
    ("shown", "text"),
    [
        ({"a": np.array([1, 9])}, r"observation\['a'\]\[1\] is 9, outside the observation space"),
        ({"a": np.array([1])}, r"observation\['a'\] must have shape \(2,\), the space's, got \(1,\)"),
        ({"b": np.array([1])}, r"must have a part observation\['a'\]"),
        ({"a": np.array([1.0, 0.5])}, r"observation\['a'\] must hold integers"),
        ({"a": np.array(["x", "y"])}, r"observation\['a'\] must hold integers"),
        (3, r"must have a part observation\['a'\]"),
    ],
    ids=str,
)
def test_an_observation_that_is_not_one_of_the_space_is_refused(shown: Any, text: str) -> None:
    env = Sampled(Dict(a=Box(0, 4, (2,), np.int64)))
    env.reset = lambda **_: (shown, {})  # type: ignore[method-assign]
    with pytest.raises((TypeError, ValueError), match=text):
        qtab.train(env, **SETTINGS)
    run = qtab.train(Sampled(Dict(a=Box(0, 4, (2,), np.int64))), **SETTINGS)
    with pytest.raises((TypeError, ValueError), match=text):
        run.predict(shown)


def test_the_grid_world_of_gymnasiums_tutorial_is_learned_as_it_is() -> None:
    env = Tutorial(size=3)
    run = qtab.train(env, episodes=500, learning_rate=0.5, discount=0.95, initial_q=0.0, epsilon=1.0, seed=0)
    assert run.q_table.shape == (3, 3, 3, 3, 4)
    played = qtab.evaluate(run, episodes=100, seed=1, env=Tutorial(size=3))
    assert played.terminated.all()
    assert played.lengths.max() <= 4  # the longest way between two cells
    with pytest.raises(ValueError, match="env must have the spaces of the run's Tutorial"):
        qtab.evaluate(run, env=Tutorial(size=5))
    short = qtab.train(env, episodes=5, max_episode_steps=30, seed=0)
    assert qtab.verify(short, env=Tutorial(size=3)).equal
