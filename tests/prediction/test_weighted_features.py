"""Features with values other than 1: equal to plain NumPy to the bit, for every method that has a meaning with them."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import qtab
from qtab.envs.book.random_mdp import random_mdp
from qtab.prediction.verification import verify_values
from support.learners.box_prediction import CAR, with_the_velocity
from support.learners.weighted_prediction import WEIGHTED, options_of

FOURIER: dict[str, Any] = {"discretizer": "fourier", "learning_rate": 0.01, "episodes": 3, "max_episode_steps": 40}
TARGET = np.random.default_rng(0).dirichlet(np.ones(3), size=6)


@pytest.mark.parametrize("method", WEIGHTED)
@settings(max_examples=settings().max_examples // 6)
@given(data=st.data())
def test_vectors_of_states_equal_plain_numpy(method: Any, data: st.DataObject) -> None:
    options = options_of(method, data)
    count, limit = data.draw(st.integers(1, 7)), data.draw(st.sampled_from([3, 30]))
    vectors = np.random.default_rng(count).uniform(-1.0, 1.0, (6, count))
    if method == "monte_carlo":
        options["first_visit"] = data.draw(st.booleans())
    if method != "lstd" and data.draw(st.booleans()):
        options["initial_weights"] = np.linspace(-1.0, 2.0, count)
    found = qtab.estimate_values(
        random_mdp(6, 2, actions=3),
        TARGET,
        method=method,
        features=vectors,
        episodes=4,
        discount=data.draw(st.sampled_from([0.0, 0.9, 1.0])),
        max_episode_steps=limit,
        on_truncation=data.draw(st.sampled_from(["bootstrap", "terminate"])),
        bit_generator=data.draw(st.sampled_from(["PCG64", "MT19937"])),
        seeds=[data.draw(st.integers(0, 1000))],
        **options,
    )
    assert verify_values(found, None, None, gym.wrappers.TimeLimit(random_mdp(6, 2, actions=3), limit)).equal


@pytest.mark.parametrize("method", WEIGHTED)
def test_unit_vectors_are_a_table(method: Any) -> None:
    given: dict[str, Any] = {"learning_rate": 0.25, "second_learning_rate": 0.125, "trace_decay": 0.5, "n_steps": 3}
    taken = {
        "td": "learning_rate",
        "n_step_td": "learning_rate n_steps",
        "monte_carlo": "learning_rate",
        "off_policy_td": "learning_rate behavior",
        "gtd2": "learning_rate second_learning_rate",
        "tdc": "learning_rate second_learning_rate",
        "emphatic_td": "learning_rate",
        "lstd": "trace_decay",
        "off_policy_td_lambda": "learning_rate trace_decay behavior",
    }.get(method, "learning_rate trace_decay")
    options = {name: value for name, value in {**given, "behavior": "random"}.items() if name in taken.split()}
    arguments: dict[str, Any] = {"method": method, "episodes": 5, "discount": 0.5, "seeds": 2, **options}
    walk: dict[str, Any] = {"env_kwargs": {"states": 7}}
    lean = np.tile([0.4, 0.6], (7, 1))
    table = qtab.estimate_values("qtab/RandomWalk-v0", lean, **arguments, **walk)
    vectors = qtab.estimate_values("qtab/RandomWalk-v0", lean, features=np.eye(7), **arguments, **walk)
    assert vectors.weights.tobytes() == table.weights.tobytes()
    assert vectors.values.tobytes() == table.values.tobytes()
    assert vectors.value(3).tolist() == table.value(3).tolist()


def test_values_are_products_of_vectors_and_weights() -> None:
    vectors = np.random.default_rng(1).standard_normal((7, 3))
    walk: dict[str, Any] = {"env_kwargs": {"states": 7}}
    found = qtab.estimate_values(
        "qtab/RandomWalk-v0", "random", features=vectors, learning_rate=0.01, episodes=20, seeds=3, **walk
    )
    assert (found.weights.shape, found.n_active, found.rows) == ((3, 20, 3), 3, None)
    np.testing.assert_allclose(found.values, found.weights[:, -1] @ vectors.T, rtol=1e-12)
    assert np.array_equal(found.value(2), found.values[:, 2])
    assert np.array_equal(found.value([2, 5]), found.values[:, [2, 5]])
    assert found.rms_error(np.zeros(7)).shape == (3, 20)
    assert len(found.plot(true_values=np.zeros(7)).lines) == 2
    car = qtab.estimate_values(CAR, "random", **FOURIER, order=2, seeds=2)
    observations = np.array([[-0.5, 0.0], [0.3, 0.05]], np.float32)
    assert car.discretizer is not None
    x: NDArray[np.float64] = car.discretizer.active_features(observations)
    np.testing.assert_allclose(car.value(observations), car.weights[:, -1] @ x.T, rtol=1e-12)
    assert car.value(observations[0]).shape == (2,)
    assert repr(car) == "<ValueEstimates of MountainCar-v0: td, 9 features, 2 runs of 3 episodes>"
    car.plot()


def test_a_function_gives_the_feature_vector_of_each_discrete_observation() -> None:
    def x(hand: tuple[int, int, int]) -> list[float]:
        points, dealer, ace = hand
        return [1.0, points / 32, dealer / 10, ace, ace * points / 32]

    vectors = np.array([x(hand) for hand in np.ndindex(32, 11, 2)])
    options: dict[str, Any] = {"method": "lstd", "episodes": 200, "record": 200}
    found = qtab.estimate_values("Blackjack-v1", "random", features=x, **options)
    given = qtab.estimate_values("Blackjack-v1", "random", features=vectors, **options)
    assert found.feature_vectors is not None
    assert found.feature_vectors.tobytes() == vectors.tobytes()
    assert found.weights.tobytes() == given.weights.tobytes()
    assert found.verify(200).equal
    walk = qtab.estimate_values(
        "qtab/RandomWalk-v0", "random", features=lambda state: (1, state), learning_rate=0.001, episodes=3
    )
    assert walk.feature_vectors is not None
    assert walk.feature_vectors.tolist() == [[1, state] for state in range(19)]
    assert walk.verify().equal


def test_estimates_are_saved_with_their_features(tmp_path: Any) -> None:
    path, at = tmp_path / "values.npz", np.array([[-0.5, 0.0], [0.3, 0.05]], np.float32)
    bases: list[dict[str, Any]] = [
        {"order": 2},
        {"order": 3, "coupled": False, "scale_step_sizes": False},
        {"discretizer": "polynomial", "order": 2, "coupled": False},
        {"discretizer": "radial", "centers": (3, 4), "width": 0.75, "normalized": True},
        {"discretizer": "coarse", "centers": 4, "radius": (1.5, 1.25)},
    ]
    for basis in bases:
        car = qtab.estimate_values(CAR, with_the_velocity, **{**FOURIER, **basis})
        car.save(path)
        again = qtab.ValueEstimates.load(path)
        assert np.array_equal(again.value(at), car.value(at))
        assert repr(again) == repr(car)
    vectors = np.random.default_rng(1).standard_normal((19, 3))
    options: dict[str, Any] = {"method": "tdc", "learning_rate": 0.01, "second_learning_rate": 0.02, "episodes": 3}
    found = qtab.estimate_values("qtab/RandomWalk-v0", "random", features=vectors, **options)
    found.save(path)
    again = qtab.ValueEstimates.load(path)
    assert (again.settings, again.values.tobytes()) == (found.settings, found.values.tobytes())
    with np.load(path) as file:
        arrays = dict(file)
    for damaged in (vectors[:5], vectors[:, :2], vectors.astype(np.float32), vectors[0]):
        np.savez(path, **{**arrays, "feature_vectors": damaged})
        with pytest.raises(ValueError, match="not a file of value estimates"):
            qtab.ValueEstimates.load(path)


class Slope(gym.Env[Any, Any]):
    """A step of random length to either side, from 0 to the ends at -1 and 1, stepped in Python."""

    action_space = gym.spaces.Discrete(2)
    at = 0.0

    def __init__(self, dtype: Any) -> None:
        self.observation_space = gym.spaces.Box(-2.0, 2.0, (1,), dtype)

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        super().reset(seed=seed)
        self.at = 0.0
        return np.zeros(1, self.observation_space.dtype), {}

    def step(self, action: int) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        self.at += (2 * action - 1) * 0.3 * self.np_random.random()
        return np.array([self.at], self.observation_space.dtype), -1.0, abs(self.at) >= 1, False, {}


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("policy", ["random", lambda at: int(at[0] >= 0)], ids=["random", "function"])
def test_an_environment_in_python_is_stepped_there(dtype: Any, policy: Any) -> None:
    methods: list[dict[str, Any]] = [
        {"order": 2, "method": "td_lambda", "trace_decay": 0.8},
        {"order": 70, "method": "monte_carlo"},
    ]
    for options in methods:
        found = qtab.estimate_values(Slope(dtype), policy, **FOURIER, **options)
        assert verify_values(found, None, None, gym.wrappers.TimeLimit(Slope(dtype), 40)).equal


WALK: dict[str, Any] = {"env": "qtab/RandomWalk-v0", "features": np.ones((19, 2)), "learning_rate": 0.1}
MOUNTAIN: dict[str, Any] = {"env": CAR, **FOURIER}


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({**WALK, "features": np.ones((18, 2))}, ValueError, r"features must have a feature vector for .* 19 states"),
        ({**WALK, "features": np.full((19, 2), np.nan)}, ValueError, "features must be finite"),
        ({**WALK, "features": np.ones(19)}, TypeError, "features must be None or an array of integers, or of floats"),
        (
            {**WALK, "features": lambda state: "x"},
            TypeError,
            "features for the observation 0 must hold numbers, got 'x'",
        ),
        ({**WALK, "features": lambda state: [np.inf]}, ValueError, "features for the observation 0 must be finite"),
        ({**WALK, "features": lambda state: None}, TypeError, "features must return a vector of numbers, got None for"),
        ({**WALK, "features": lambda state: 1.0}, ValueError, r"features must return a vector of numbers, got"),
        (
            {**WALK, "features": lambda state: np.ones(1 + state // 5)},
            ValueError,
            r"features must return a vector of 1 number, got the shape \(2,\) for the observation 5",
        ),
        (
            {"env": CAR, "features": lambda at: at, "learning_rate": 0.1},
            ValueError,
            "features must be an array for observations that are not discrete, got a function; to learn",
        ),
        ({**MOUNTAIN, "features": lambda at: at}, ValueError, "features must be None for discretizer 'fourier'"),
        ({**WALK, "learning_rate": None}, ValueError, "learning_rate must be given for features with values other"),
        ({**WALK, "learning_rate_schedule": "visits"}, ValueError, "learning_rate_schedule must be 'constant', 'linea"),
        ({**WALK, "initial_value": 1.0}, ValueError, r"initial_value must be 0 .*; initial_weights= sets each weight"),
        (
            {**WALK, "initial_weights": np.ones(3)},
            ValueError,
            r"initial_weights must have the shape \(2,\), got \(3,\)",
        ),
        (
            {**WALK, "initial_weights": np.ones(2), "initial_value": 1.0},
            ValueError,
            "initial_value must be 0 with initial_weights, got 1.0",
        ),
        (
            {**WALK, "method": "batch_td", "learning_rate": None},
            ValueError,
            "features must be None or an array of integers for method 'batch_td', which averages in each cell",
        ),
        (
            {**WALK, "method": "lstd", "learning_rate": None, "initial_weights": [1, 2]},
            ValueError,
            "initial_weights must be None for method 'lstd', whose weights follow from the steps",
        ),
        (
            {**MOUNTAIN, "features": np.ones((9, 2))},
            ValueError,
            "features must be None for discretizer 'fourier', which",
        ),
        ({**MOUNTAIN, "learning_rate": None}, ValueError, "learning_rate must be given for features with values other"),
        ({**MOUNTAIN, "initial_value": 1.0}, ValueError, "initial_value must be 0 for features with values other"),
        ({**MOUNTAIN, "method": "monte_carlo", "first_visit": True}, ValueError, "first_visit must be False for disc"),
        (
            {**MOUNTAIN, "method": "importance_sampling", "behavior": "random", "learning_rate": None},
            ValueError,
            "discretizer must be 'round', 'bins' or 'edges' for method 'importance_sampling'",
        ),
        (
            {**MOUNTAIN, "method": "lstd", "learning_rate": None, "scale_step_sizes": True},
            ValueError,
            "scale_step_sizes must be False for method 'lstd', which has no step size",
        ),
        ({**MOUNTAIN, "order": 50}, ValueError, "order must give at most 1,024 features, got 50"),
        ({**MOUNTAIN, "bins": 3}, ValueError, "bins applies to discretizer 'bins', not to 'fourier'"),
        ({**MOUNTAIN, "policy": np.zeros(16, int)}, ValueError, "policy must be a function, .* for weighted features"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        qtab.estimate_values(**{"policy": "random", **arguments})


def test_a_fourier_basis_has_no_array_of_values() -> None:
    found = qtab.estimate_values(CAR, "random", **FOURIER)
    with pytest.raises(
        ValueError, match=r"values need cells, which weighted features do not have; value\(observation\)"
    ):
        found.values  # noqa: B018


@pytest.mark.parametrize(
    ("method", "options", "remedy"),
    [
        ("td", {}, "a smaller learning_rate helps"),
        ("monte_carlo", {}, "a smaller learning_rate helps"),
        ("td_lambda", {"trace_decay": 0.9}, "a smaller learning_rate, trace_decay or discount helps"),
        (
            "off_policy_td",
            {"behavior": "random"},
            "may help, but off policy this method can diverge with any learning rate: 'tdc' does",
        ),
        (
            "tdc",
            {"behavior": "random", "second_learning_rate": 2.0},
            "a smaller learning_rate helps, and a smaller second_learning_rate if that is above it",
        ),
        ("emphatic_td", {"behavior": "random"}, "a smaller learning_rate or discount helps"),
    ],
)
def test_values_that_diverge_are_an_error_that_says_what_helps(
    method: Any, options: dict[str, Any], remedy: str
) -> None:
    given: dict[str, Any] = {**FOURIER, "learning_rate": 2.0, "episodes": 50, "max_episode_steps": 200, **options}
    message = rf"the values diverged in episode \d+ \(counted from 0\): .*{remedy}"
    with pytest.raises(OverflowError, match=message):
        qtab.estimate_values(CAR, "random", method=method, order=9, scale_step_sizes=False, **given)
