"""The Fourier basis: its features, the learners with them, and what is refused."""

import math
from pathlib import Path
from typing import Any, get_args

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab import _core
from qtab.config.choices import Algorithm
from qtab.config.options import LEARNS_WEIGHTED, OPTIONS, PREFERENCES
from qtab.discretizers.weighted.fourier import FourierBasis
from qtab.reference.parts.weighted import FourierBasis as Reference
from qtab.training.setup.resolve import resolve

CAR = "MountainCar-v0"
FOURIER: dict[str, Any] = {"discretizer": "fourier", "learning_rate": 0.005, "seed": 3, "progress": False}
PROFILE: Any = settings.default


def basis_of(space: gym.spaces.Box, **options: Any) -> tuple[FourierBasis, Reference]:
    config = qtab.Config(discretizer="fourier", **{"order": 3, "coupled": True, "scale_step_sizes": True} | options)
    built = FourierBasis.build(space, config, 3)
    return built, Reference(space, config.replace(**built.settings()))


@settings(max_examples=PROFILE.max_examples // 2, deadline=None)
@given(st.data())
def test_the_features_are_those_of_the_reference_to_the_last_bit_and_nearly_the_cosines(data: st.DataObject) -> None:
    dimensions, coupled = data.draw(st.integers(1, 4)), data.draw(st.booleans())
    order = data.draw(st.integers(1, {1: 60, 2: 17, 3: 6, 4: 3}[dimensions] if coupled else 60))
    dtype: Any = data.draw(st.sampled_from([np.float32, np.float64]))
    low = data.draw(st.lists(st.floats(-9, 9, width=16), min_size=dimensions, max_size=dimensions))
    space = gym.spaces.Box(np.array(low, dtype), np.array(low, dtype) + dtype(2.5), dtype=dtype)
    built, reference = basis_of(space, order=order, coupled=coupled)
    shares = st.lists(st.floats(-0.25, 1.25, width=32), min_size=dimensions, max_size=dimensions)
    observations = space.low + dtype(2.5) * np.array(data.draw(st.lists(shares, min_size=1, max_size=5)), dtype)
    found = built.feature_values(observations)
    assert found.tobytes() == np.array([reference.rows(one).x for one in observations]).tobytes()
    s = (np.clip(observations.astype(float), *built.span) - built.span[0]) / (built.span[1] - built.span[0])
    np.testing.assert_allclose(found, np.cos(math.pi * (s @ np.array(reference.c).T)), rtol=0, atol=1e-12)
    assert found[0].tobytes() == built.feature_values(observations[0]).tobytes()


@st.composite
def runs(draw: st.DrawFn, algorithm: str) -> dict[str, Any]:
    rate = draw(st.floats(0, 0.02))
    policies: list[Any] = [{"exploration": "softmax", "temperature": 0.5}, {"epsilon": 0.2}]
    exploration = draw(st.sampled_from(policies[:1] if algorithm in PREFERENCES else policies))
    schedule: Any = draw(st.sampled_from([{}, {"learning_rate_schedule": "linear", "min_learning_rate": rate / 2}]))
    options: Any = draw(
        st.fixed_dictionaries(
            {
                "order": st.integers(1, 5),
                "coupled": st.booleans(),
                "scale_step_sizes": st.booleans(),
                "initial_q": st.sampled_from([0.0, (-1.0, 1.0)]),
                "seed": st.integers(0, 2**40),
                "episodes": st.integers(1, 4),
                "max_episode_steps": st.integers(1, 60),
                "bit_generator": st.just("PCG64"),
            }
        )
    )
    limits: Any = draw(st.sampled_from([{}, {"low": (-1.0, -0.05), "high": (0.5, 0.05)}]))
    own = {
        "trace_decay": st.sampled_from([0.0, 0.5, 0.9, 1.0]),
        "trace_cutoff": st.sampled_from([0.0, 0.01]),
        "value_learning_rate": st.floats(0, 0.02),
    }
    applying = {name: drawn for name, drawn in own.items() if algorithm in OPTIONS[name].values}
    options |= draw(st.fixed_dictionaries(applying))
    return {"algorithm": algorithm, "learning_rate": rate, **exploration, **schedule, **options, **limits}


@pytest.mark.parametrize("algorithm", LEARNS_WEIGHTED)
def test_random_settings_give_the_table_of_the_reference(algorithm: str) -> None:
    @settings(max_examples=max(2, PROFILE.max_examples // 10), deadline=None)
    @given(runs(algorithm))
    def check(chosen: dict[str, Any]) -> None:
        run = qtab.train(CAR, discretizer="fourier", progress=False, **chosen)
        verification = qtab.verify(run)
        assert verification.equal, f"{chosen}\n{verification}"

    check()


@pytest.mark.parametrize("algorithm", get_args(Algorithm))
def test_python_and_rust_learn_with_the_same_algorithms(algorithm: Any) -> None:
    try:
        qtab.train(CAR, discretizer="fourier", algorithm=algorithm, episodes=1, progress=False)
    except ValueError as error:
        assert str(error).startswith("algorithm must be 'q_learning'")  # noqa: PT017
        assert algorithm not in LEARNS_WEIGHTED
    else:
        assert algorithm in LEARNS_WEIGHTED
    fourier: Any = resolve(CAR, {"discretizer": "fourier", "episodes": 2}).spec()["discretizer"]
    given = {"algorithm": algorithm, "scale": (10, 100), "episodes": 2, "preset": None}
    spec: Any = resolve(CAR, given).spec()
    spec |= {"discretizer": fourier, "settings": {**spec["settings"], "terminal_update": "target"}}
    if spec["settings"].get("traces") == "replacing":
        with pytest.raises(ValueError, match=r"^traces must be a setting that works with weighted features"):
            _core.Trainer(spec, 0)
        spec["settings"]["traces"] = "accumulating"
    if algorithm in LEARNS_WEIGHTED:
        _core.Trainer(spec, 0)
    else:
        with pytest.raises(ValueError, match=r"^algorithm must be a setting that works with weighted features"):
            _core.Trainer(spec, 0)


def test_a_value_is_the_sum_of_products_and_the_prediction_its_argmax(tmp_path: Path) -> None:
    run = qtab.train(CAR, episodes=20, order=5, algorithm="sarsa", **FOURIER)
    run.save(tmp_path / "run.npz")
    observations = np.array([[-0.5, 0.0], [0.3, 0.02], [-1.1, -0.01]], np.float32)
    discretizer: Any = run.discretizer
    for one, x in zip(observations, discretizer.feature_values(observations), strict=True):
        parts = np.zeros((4, 3))
        for index, (value, weights) in enumerate(zip(x, run.tables[0], strict=True)):
            parts[index % 4] += value * weights
        total = (parts[0] + parts[1]) + (parts[2] + parts[3])
        assert run.q_values(one).tobytes() == total.tobytes()
        assert run.predict(one)[0] == np.argmax(total)
        assert run.values(one) == total.max()
    assert qtab.load(tmp_path / "run.npz").q_values(observations).tobytes() == run.q_values(observations).tobytes()
    assert repr(discretizer) == "<FourierBasis: 36 features of order 5>"
    assert "36 features" in discretizer._repr_html_()
    with pytest.raises(ValueError, match=r"^q_table needs cells, which discretizer 'fourier' does not have"):
        _ = run.q_table
    with pytest.raises(ValueError, match=r"^every row of FourierBasis is active for every observation"):
        discretizer.active_rows(observations)


def test_pictures_show_the_values_between_the_limits() -> None:
    pytest.importorskip("matplotlib")
    import matplotlib.pyplot as plt

    run = qtab.train(CAR, episodes=20, **FOURIER)
    axes = qtab.plots.values(run)
    shown = np.asarray(axes.collections[0].get_array() if axes.collections else axes.images[0].get_array())
    assert np.isfinite(shown).all()
    middle = run.values(np.array([-0.3 + 0.9 / 200, 0.07 / 200], np.float32))
    assert np.isclose(shown.reshape(200, 200)[100, 100], middle)
    qtab.plots.policy(run)
    plt.close("all")


@pytest.mark.parametrize("algorithm", ["q_learning", "double_q_learning"])
def test_the_rendered_agent_plays_the_policy_of_evaluate(algorithm: Any) -> None:
    from qtab.rendering.agent import agent_of

    settings_of_run = {**FOURIER, "initial_q": (-1.0, 1.0)}
    run = qtab.train(CAR, episodes=20, algorithm=algorithm, max_episode_steps=40, **settings_of_run)
    act = agent_of(run).act
    observations = np.random.default_rng(0).uniform((-1.2, -0.07), (0.6, 0.07), (50, 2)).astype(np.float32)
    assert [act(one, None, None)[0] for one in observations] == run.predict(observations)[0].tolist()
    masked = act(observations[0], None, np.arange(3) != act(observations[0], None, None)[0])[0]
    assert masked != act(observations[0], None, None)[0]


def test_a_run_is_played_and_written_as_a_page(tmp_path: Path) -> None:
    pytest.importorskip("pygame")
    pytest.importorskip("matplotlib")
    run = qtab.train(CAR, episodes=20, max_episode_steps=15, **FOURIER)
    played = qtab.play(run, 1, seed=5, window=False)
    assert np.array_equal(played.returns, qtab.evaluate(run, 1, seed=5).returns)
    run.to_html(tmp_path / "run.html")
    assert (tmp_path / "run.html").stat().st_size > 1000


@pytest.mark.parametrize("env", [CAR, "CartPole-v1"])
def test_the_rates_of_presets_for_cells_are_set_aside(env: str) -> None:
    def rates(preset: str, **given_settings: Any) -> tuple[Any, ...]:
        config = resolve(env, {"discretizer": "fourier", "preset": preset, **given_settings}).config
        return config.learning_rate, config.learning_rate_schedule, config.initial_q, config.min_learning_rate

    for preset in qtab.presets(env):
        assert rates(preset) == (0.001, "constant", 0.0, None)
        assert rates(preset, learning_rate=0.01, initial_q=2.0) == (0.01, "constant", 2.0, None)
        assert rates(preset, learning_rate_schedule="linear") == (0.001, "linear", 0.0, 0.0)
        assert rates(preset, min_learning_rate=0.0005) == (0.001, "linear", 0.0, 0.0005)
    config = qtab.Config(env, discretizer="fourier", episodes=2)
    assert (config.learning_rate, config.initial_q) == (0.001, 0.0)
    assert qtab.Config(env, discretizer="fourier", learning_rate=0.2).learning_rate == 0.2


def test_the_default_rate_learns_cart_pole() -> None:
    run = qtab.train("CartPole-v1", discretizer="fourier", order=2, episodes=1000, seed=0, progress=False)
    assert run.episode_returns[-100:].mean() > 300
    assert np.abs(run.tables).max() < 1000


@pytest.mark.parametrize(
    ("given_settings", "message"),
    [
        ({"algorithm": "dyna_q"}, r"^algorithm must be 'q_learning', .* for discretizer 'fourier', got 'dyna_q'"),
        (
            {"algorithm": "sarsa_lambda", "traces": "replacing"},
            r"^traces must be 'accumulating' for discretizer 'fourier', .* got 'replacing'; .* has dutch traces",
        ),
        ({"algorithm": "monte_carlo"}, r"^algorithm must be 'q_learning', .* for discretizer 'fourier', got 'monte_c"),
        (
            {"exploration": "ucb"},
            r"^exploration must be .* for discretizer 'fourier', whose features have no visits to count",
        ),
        ({"learning_rate_schedule": "visits"}, r"^learning_rate_schedule must be .* for discretizer 'fourier'"),
        ({"terminal_update": "assign"}, r"^terminal_update must be 'target' for discretizer 'fourier', got 'assign'"),
        ({"action_mask": True}, r"^action_mask must be False for discretizer 'fourier', got True"),
        ({"count_bonus": 0.5}, r"^count_bonus must be 0 for discretizer 'fourier', whose states cannot be counted"),
        ({"time_aware": True}, r"^time_aware must be False for discretizer 'fourier'.*TimeAwareObservation"),
        ({"max_rows": 9}, r"^max_rows applies to discretizer .*, not to 'fourier', got 9"),
        ({"order": 0}, r"^order must be an integer from 1 to 1023, got 0"),
        (
            {"order": 40},
            r"^order must give at most 1,024 features, got 40 with 2 .* gives 1,681; coupled=False gives 81",
        ),
        (
            {"order": 1023, "coupled": False},
            r"^order must give at most 1,024 features, got 1023 with 2 .* gives 2,047$",
        ),
        ({"low": (0.6, 0.0), "high": (-1.2, 0.1)}, r"^high must lie above low"),
        ({"low": (-1e308, 0.0), "high": (1e308, 1.0)}, r"^high - low must be finite in float64, got low="),
        ({"visits": True}, r"^visits must be False for discretizer 'fourier', whose states cannot be counted"),
        ({"discretizer": {"x": "fourier"}}, r"^discretizer\['x'\] must be 'round', .*, because 'fourier' has no rows"),
        (
            {"initial_q": np.array([[0.0, -np.inf, 0.0]] * 16)},
            "^discretizer must be 'round', 'bins', 'edges' or 'identity' for an initial_q that contains -inf, got 'fou",
        ),
    ],
    ids=str,
)
def test_what_has_no_meaning_is_refused_by_name(given_settings: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        qtab.train(CAR, episodes=2, **{**FOURIER, **given_settings})


def test_spaces_without_finite_bounds_need_limits() -> None:
    with pytest.raises(ValueError, match=r"^low must be given, .* no finite bounds"):
        basis_of(gym.spaces.Box(-np.inf, np.inf, (4,), np.float32))
    limits: Any = {"low": (-2.4, -3, -0.2, -3), "high": (2.4, 3, 0.2, 3)}
    run = qtab.train("CartPole-v1", episodes=3, order=2, **limits, **FOURIER)
    assert run.tables.shape == (1, 81, 2)
    assert qtab.verify(run).equal
    with pytest.raises(
        ValueError, match=r"^discretizer must be another one for an observation space that is not a Box"
    ):
        qtab.train("Blackjack-v1", episodes=1, **FOURIER)


def test_a_function_that_reads_rows_refuses_the_run() -> None:
    run = qtab.train(CAR, episodes=2, **FOURIER)
    with pytest.raises(ValueError, match=r"^run must have rows for its observations to be diagnosed, got weighted"):
        qtab.diagnose(run)


def test_a_step_size_that_diverges_is_named() -> None:
    with pytest.raises(OverflowError, match=r"learning_rate"):
        qtab.train(CAR, episodes=200, order=9, scale_step_sizes=False, **{**FOURIER, "learning_rate": 1.5})


def test_an_action_value_that_is_not_a_number_is_an_error() -> None:
    # ∞ - ∞ for the last action, and 0 for the others. Comparisons would pass over it; NumPy's argmax does not.
    weights = np.zeros((16, 3))
    weights[[0, 4, 5, 9], 2] = 1.7e308
    with pytest.raises(OverflowError, match=r"^the action values overflowed in episode 0"):
        qtab.train(CAR, episodes=1, max_episode_steps=1, **{**FOURIER, "epsilon": 0.0, "initial_q": weights})
