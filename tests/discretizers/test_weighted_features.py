"""Polynomials, radial basis functions and coarse coding: their features, the learners with them, and what is refused.

What they share with the Fourier basis is tested in ``test_fourier.py``, too.
"""

import itertools
import math
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import qtab
from qtab.cli.command import parser_of
from qtab.cli.commands.train import env_and_settings
from qtab.config.options import LEARNS_WEIGHTED, WITH_STATE_VALUES
from qtab.config.options import WEIGHTED as NAMES
from qtab.discretizers.named import DISCRETIZERS, class_at
from qtab.reference.parts.weighted import WEIGHTED as REFERENCES
from qtab.training.setup.resolve import resolve

CAR = "MountainCar-v0"
PROFILE: Any = settings.default
KINDS: dict[str, dict[str, Any]] = {
    "polynomial": {"order": 4},
    "radial": {"centers": (5, 4), "width": 1.2, "normalized": True},
    "coarse": {"centers": 6, "radius": (1.5, 2.0)},
}


def given_settings(kind: str, **others: Any) -> dict[str, Any]:
    return {"discretizer": kind, **KINDS[kind], "learning_rate": 0.01, "seed": 3, "progress": False, **others}


def test_every_kind_has_a_class_and_a_reference() -> None:
    assert set(NAMES) == set(REFERENCES) == {"fourier", *KINDS}
    assert set(NAMES) <= set(DISCRETIZERS)


def options_of(draw: Any, kind: str, dimensions: int) -> dict[str, Any]:
    """Draws the options of a kind, with at most 700 features of so many components."""
    if kind in ("fourier", "polynomial"):
        coupled = draw(st.booleans())
        most = {1: 70, 2: 20, 3: 7, 4: 3}[dimensions] if coupled else 70
        return {"order": draw(st.integers(1, most)), "coupled": coupled}
    most = {1: 80, 2: 20, 3: 8, 4: 5}[dimensions]
    centers = draw(st.tuples(*[st.integers(2, most)] * dimensions))
    if kind == "radial":
        width = draw(st.one_of(st.floats(0.1, 9), st.tuples(*[st.floats(0.1, 9)] * dimensions)))
        return {"centers": centers, "width": width, "normalized": draw(st.booleans())}
    least = math.sqrt(dimensions) / 2 + 0.001
    radius = draw(st.tuples(*[st.floats(least, max(least, count - 1.1)) for count in centers]))
    return {"centers": centers, "radius": radius}


def expected_features(kind: str, options: Any, s: NDArray[np.float64]) -> NDArray[np.float64]:
    """The features of a state in [0, 1]^d by their definitions, and for coarse coding the squared distances."""
    if kind == "polynomial":
        if options.coupled:
            exponents = np.array(list(itertools.product(range(options.order + 1), repeat=len(s))))
        else:
            powers = np.arange(1, options.order + 1)
            rows = [np.multiply.outer(powers, unit) for unit in np.eye(len(s), dtype=int)]
            exponents = np.concatenate([np.zeros((1, len(s)), int), *rows])
        return np.asarray(np.prod(s**exponents, axis=1))
    extent = np.array(options.width if kind == "radial" else options.radius)
    centers = np.array(list(itertools.product(*map(range, options.centers))))
    squared = (((s * (np.array(options.centers) - 1) - centers) / extent) ** 2).sum(axis=1)
    if kind == "coarse":
        return np.asarray(squared)
    x = np.exp(-squared / 2)
    return np.asarray(x / x.sum() if options.normalized else x)


@pytest.mark.parametrize("kind", KINDS)
def test_the_features_are_those_of_the_reference_to_the_last_bit_and_of_the_definition(kind: str) -> None:
    @settings(max_examples=PROFILE.max_examples // 2, deadline=None)
    @given(st.data())
    def check(data: st.DataObject) -> None:
        dimensions = data.draw(st.integers(1, 4))
        dtype: Any = data.draw(st.sampled_from([np.float32, np.float64]))
        low = data.draw(st.lists(st.floats(-9, 9, width=16), min_size=dimensions, max_size=dimensions))
        space = gym.spaces.Box(np.array(low, dtype), np.array(low, dtype) + dtype(2.5), dtype=dtype)
        options: Any = options_of(data.draw, kind, dimensions)
        config = qtab.Config(discretizer=kind, **options)  # type: ignore[arg-type]
        built: Any = class_at(DISCRETIZERS[kind]).build(space, config, 3)  # type: ignore[index]
        reference = REFERENCES[kind](space, config.replace(**built.settings()))
        assert reference.shape == built.shape
        shares = st.lists(st.floats(-0.25, 1.25, width=32), min_size=dimensions, max_size=dimensions)
        observations = space.low + dtype(2.5) * np.array(data.draw(st.lists(shares, min_size=1, max_size=3)), dtype)
        found = built.feature_values(observations)
        assert found.tobytes() == np.array([reference.rows(one).x for one in observations]).tobytes()
        assert found[0].tobytes() == built.feature_values(observations[0]).tobytes()
        s = (np.clip(observations.astype(float), *built.span) - built.span[0]) / (built.span[1] - built.span[0])
        for x, one in zip(found, s, strict=True):
            expected = expected_features(kind, built, one)
            if kind == "coarse":
                assert set(x) <= {0.0, 1.0}
                assert x.any()
                assert ((expected < 1 + 1e-9) | (x == 0)).all()
                assert ((expected > 1 - 1e-9) | (x == 1)).all()
            else:
                np.testing.assert_allclose(x, expected, rtol=1e-9, atol=1e-14)

    check()


@st.composite
def runs(draw: st.DrawFn, algorithm: str) -> dict[str, Any]:
    kind = draw(st.sampled_from(list(KINDS)))
    options: Any = {
        "polynomial": {"order": st.integers(1, 5), "coupled": st.booleans()},
        "radial": {"centers": st.integers(2, 7), "width": st.floats(0.1, 3), "normalized": st.booleans()},
        "coarse": {"centers": st.integers(3, 8), "radius": st.floats(0.75, 2)},
    }[kind]
    others: Any = {
        "learning_rate": st.floats(0, 0.05),
        "initial_q": st.sampled_from([0.0, (-1.0, 1.0)]),
        "seed": st.integers(0, 2**40),
        "episodes": st.integers(1, 4),
        "max_episode_steps": st.integers(1, 60),
        "epsilon": st.floats(0, 1),
    }
    limits: Any = draw(st.sampled_from([{}, {"low": (-1.0, -0.05), "high": (0.5, 0.05)}]))
    chosen = draw(st.fixed_dictionaries({**options, **others}))
    return {"algorithm": algorithm, "discretizer": kind, **chosen, **limits}


@pytest.mark.parametrize("algorithm", LEARNS_WEIGHTED)
def test_random_settings_give_the_table_of_the_reference(algorithm: str) -> None:
    @settings(max_examples=max(3, PROFILE.max_examples // 10), deadline=None)
    @given(runs(algorithm))
    def check(chosen: dict[str, Any]) -> None:
        if "epsilon" in chosen and qtab.Config(algorithm=algorithm).exploration == "softmax":  # type: ignore[arg-type]
            del chosen["epsilon"]
        verification = qtab.verify(qtab.train(CAR, progress=False, **chosen))
        assert verification.equal, f"{chosen}\n{verification}"

    check()


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_is_saved_resumed_and_shown(kind: str, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    import matplotlib.pyplot as plt

    chosen = given_settings(kind, algorithm="n_step_sarsa", episodes=9, max_episode_steps=150)
    whole = qtab.train(CAR, **chosen)
    stopped = qtab.train(CAR, **chosen, callback=lambda seen: seen.episodes < 4, callback_every=1)
    stopped.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert (loaded.config, repr(loaded.discretizer)) == (stopped.config, repr(stopped.discretizer))
    resumed = qtab.resume(loaded, progress=False)
    assert len(stopped.episode_returns) < 9
    assert resumed.tables.tobytes() == whole.tables.tobytes()
    observations = np.array([[-0.5, 0.0], [0.3, 0.02], [-1.1, -0.01]], np.float32)
    assert loaded.q_values(observations).tobytes() == stopped.q_values(observations).tobytes()
    assert np.array_equal(whole.predict(observations)[0], whole.q_values(observations).argmax(axis=1))
    axes = qtab.plots.values(whole)
    shown = np.asarray(axes.collections[0].get_array() if axes.collections else axes.images[0].get_array())
    assert np.isfinite(shown).all()
    assert np.ptp(shown) > 0
    plt.close("all")


@pytest.mark.parametrize("kind", KINDS)
def test_they_are_shown_in_one_line(kind: str) -> None:
    discretizer = resolve(CAR, {"discretizer": kind, **KINDS[kind]}).discretizer
    assert (
        repr(discretizer)
        == {
            "polynomial": "<PolynomialBasis: 25 features of order 4>",
            "radial": "<RadialBasis: 20 features around 5 × 4 centers>",
            "coarse": "<CoarseCoding: 36 features around 6 × 6 centers>",
        }[kind]
    )
    assert "features" in discretizer._repr_html_()


def test_the_config_of_a_run_has_a_number_for_each_component() -> None:
    config = qtab.train(CAR, episodes=1, discretizer="radial", progress=False).config
    assert (config.centers, config.width, config.normalized, config.radius) == ((5, 5), (1.0, 1.0), False, None)
    assert (config.learning_rate, config.initial_q) == (0.001, 0.0)
    for normalized in (True, np.True_):
        options: Any = {"discretizer": "radial", "algorithm": "actor_critic", "normalized": normalized, "preset": None}
        config = resolve(CAR, options).config
        assert (config.learning_rate, config.value_learning_rate) == (0.1, 0.1)
        assert resolve(CAR, {**options, "learning_rate": 0.02}).config.learning_rate == 0.02
    assert resolve(CAR, {**options, "normalized": False}).config.value_learning_rate == 0.005
    assert qtab.Config(CAR, discretizer="radial", normalized=True).learning_rate == 0.1
    config = qtab.train(CAR, episodes=1, discretizer="coarse", progress=False).config
    assert (config.centers, config.radius, config.width) == ((5, 5), (1.5, 1.5), None)


def test_normalized_features_sum_to_one_so_that_equal_weights_are_values() -> None:
    run = qtab.train(CAR, episodes=1, learning_rate=0.0, initial_q=-7.0, discretizer="radial", normalized=True, seed=0)
    observations = np.random.default_rng(0).uniform((-1.2, -0.07), (0.6, 0.07), (50, 2)).astype(np.float32)
    np.testing.assert_allclose(run.q_values(observations), -7.0, rtol=1e-12)


def test_the_command_line_reads_the_options() -> None:
    words = ["--discretizer", "radial", "--centers", "5", "4", "--width", "0.5", "--normalized", "True"]
    chosen = env_and_settings(parser_of("train", words).read())[1]
    assert chosen == {"discretizer": "radial", "centers": (5, 4), "width": (0.5,), "normalized": True}
    assert resolve(CAR, chosen).discretizer.shape == (20,)


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        (
            {"discretizer": "coarse", "algorithm": "sarsa_lambda", "traces": "replacing"},
            r"^traces must be 'accumulating' for .*, because the others are not implemented, got 'replacing'; .* dutch",
        ),
        ({"discretizer": "polynomial", "order": 0}, r"^order must be an integer from 1 to 1023, got 0"),
        (
            {"discretizer": "polynomial", "order": 40},
            r"^order must give at most 1,024 features, got 40 with 2 .* gives 1,681; coupled=False gives 81",
        ),
        (
            {"discretizer": "polynomial", "scale_step_sizes": True},
            r"^scale_step_sizes applies to discretizer 'fourier'",
        ),
        ({"discretizer": "radial", "centers": 1}, r"^centers must be an integer from 2 to 1024, got 1"),
        (
            {"discretizer": "radial", "centers": (40, 30)},
            r"^centers must give at most 1,024 features, got \(40, 30\), which gives 1,200; centers=32 gives 1,024$",
        ),
        ({"discretizer": "coarse", "centers": (3, 3, 3)}, r"^centers must hold 2 numbers .*, got \(3, 3, 3\)"),
        ({"discretizer": "radial", "width": 0}, r"^width must lie in \[0.1, 1000\], got 0"),
        ({"discretizer": "radial", "width": float("nan")}, r"^width must lie in \[0.1, 1000\], got nan"),
        (
            {"discretizer": "radial", "centers": (9, 2), "width": 11},
            r"^width must be at most 10 with 2 centers along component 1, because wider features hardly differ, got 11",
        ),
        (
            {"discretizer": "coarse", "radius": 0.7},
            r"^radius must be large enough that every .* at least 0.708 for each of 2 components, got \(0.7, 0.7\)",
        ),
        (
            {"discretizer": "coarse", "centers": 3, "radius": 9},
            r"^radius must be small .* below 2.828 for each of 2 components with \(3, 3\) centers, got \(9, 9\)$",
        ),
        (
            {"discretizer": "coarse", "width": 1.0},
            r"^width applies to discretizer 'radial', not to 'coarse', got \(1.0,\)",
        ),
        ({"discretizer": "radial", "radius": 1.0}, r"^radius applies to discretizer 'coarse', not to 'radial'"),
        ({"discretizer": "radial", "algorithm": "monte_carlo"}, r"^algorithm must be .* for discretizer 'radial'"),
        ({"discretizer": "coarse", "exploration": "ucb"}, r"^exploration must be .* for discretizer 'coarse', whose"),
        ({"discretizer": {"x": "coarse"}}, r"^discretizer\['x'\] must be 'round', .*, because 'coarse' has no rows"),
    ],
    ids=str,
)
def test_what_has_no_meaning_is_refused_by_name(chosen: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        qtab.train(CAR, episodes=2, **chosen)


@pytest.mark.parametrize("kind", KINDS)
def test_spaces_without_finite_bounds_need_limits(kind: str) -> None:
    options: Any = {"discretizer": kind, "preset": None}
    space = gym.spaces.Box(-np.inf, np.inf, (2,), np.float32)
    with pytest.raises(ValueError, match=r"^low must be given, .* no finite bounds"):
        class_at(DISCRETIZERS[kind]).build(space, resolve(CAR, options).config.replace(low=None, high=None), 2)  # type: ignore[index]
    with pytest.raises(ValueError, match=rf"^discretizer must be another one .*, got '{kind}'"):
        qtab.train("Blackjack-v1", episodes=1, **options)


@pytest.mark.parametrize("algorithm", WITH_STATE_VALUES)
def test_the_values_of_a_critic_are_its_own(algorithm: Any) -> None:
    run = qtab.train(CAR, algorithm=algorithm, discretizer="fourier", order=2, episodes=2, max_episode_steps=50)
    basis: Any = run.discretizer
    at = np.array([[-0.5, 0.0], [0.3, 0.05]], np.float32)
    values = run.values(at)
    assert values.shape == (2,)
    assert values[0] == run.values(at[0])
    expected = [basis.feature_values(one) @ run.tables[1][:, 0] for one in at]
    assert np.allclose(values, expected, rtol=1e-12)
