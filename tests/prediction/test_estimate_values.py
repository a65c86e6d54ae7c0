"""Estimated values: equal to plain NumPy to the bit, near the exact ones, and what is refused."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.prediction import METHODS, state_aggregation, tile_coding
from qtab.prediction.settings import OFF_POLICY
from qtab.prediction.verification import verify_values

WALK = "qtab/RandomWalk-v0"
LEAN = np.tile([0.4, 0.6], (7, 1))
OPTIONS: dict[str, dict[str, Any]] = {
    "td": {"learning_rate": 0.1},
    "n_step_td": {"learning_rate": 0.4, "n_steps": 4},
    "td_lambda": {"learning_rate": 0.1, "trace_decay": 0.8},
    "true_online_td_lambda": {"learning_rate": 0.2, "trace_decay": 0.8},
    "offline_lambda_return": {"learning_rate": 0.1, "trace_decay": 0.8},
    "monte_carlo": {},
    "importance_sampling": {"behavior": LEAN},
    "batch_td": {},
    "off_policy_td": {"learning_rate": 0.1, "behavior": LEAN},
    "off_policy_td_lambda": {"learning_rate": 0.1, "trace_decay": 0.8, "behavior": LEAN},
    "gtd2": {"learning_rate": 0.1, "second_learning_rate": 0.2, "behavior": LEAN},
    "tdc": {"learning_rate": 0.1, "second_learning_rate": 0.2, "behavior": LEAN},
    "emphatic_td": {"learning_rate": 0.02, "behavior": LEAN},
    "lstd": {},
}


def test_every_method_has_options_here() -> None:
    assert tuple(OPTIONS) == METHODS


@pytest.mark.parametrize("method", METHODS)
def test_a_method_equals_plain_numpy(method: Any) -> None:
    options = {**OPTIONS[method], "env_kwargs": {"states": 7}}
    found = qtab.estimate_values(WALK, "random", method=method, episodes=8, seeds=3, **options)
    assert found.verify(seed=2).equal
    assert found.verify(episodes=5).equal


@pytest.mark.parametrize("method", ["td", "importance_sampling"])
def test_policies_and_features_may_have_any_order_in_memory(method: Any) -> None:
    right = np.linspace(0.2, 0.8, 7)
    policy, rows = np.stack([1 - right, right], axis=1), np.stack([np.arange(7), np.arange(7)[::-1] + 7], axis=1)
    given: dict[str, Any] = {"td": {"features": rows}, "importance_sampling": {"behavior": policy}}[method]
    options: dict[str, Any] = {"method": method, "env_kwargs": {"states": 7}, "episodes": 8, "seeds": 2}
    target = policy if method == "td" else "random"
    expected = qtab.estimate_values(WALK, target, **options, **given)
    orders: list[Any] = [np.asfortranarray, lambda array: np.repeat(array, 2, axis=0)[::2]]
    for order in orders:
        reordered = {name: order(array) for name, array in given.items()}
        found = qtab.estimate_values(WALK, order(policy) if method == "td" else target, **options, **reordered)
        assert found.weights.tobytes() == expected.weights.tobytes()
        assert found.verify().equal


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=settings().max_examples // 6)
@given(data=st.data())
def test_any_settings_equal_plain_numpy(method: Any, data: st.DataObject) -> None:
    options = dict(OPTIONS[method])
    # Emphases grow to thousands within an episode.
    rate = st.floats(0.0, 1e-3 if method == "emphatic_td" else 0.5 if method in OFF_POLICY else 1.0)
    for name in sorted(options.keys() & {"learning_rate", "second_learning_rate", "trace_decay"}):
        options[name] = data.draw(rate)
    if method == "n_step_td":
        options["n_steps"] = data.draw(st.integers(1, 30))
    if method in ("monte_carlo", "importance_sampling"):
        options["first_visit"] = data.draw(st.booleans())
    if method == "importance_sampling":
        options["weighted"] = data.draw(st.booleans())
    if method in ("td", "n_step_td", "monte_carlo") and data.draw(st.booleans()):
        options["learning_rate"] = data.draw(st.none() | rate)
    several = [state_aggregation(7, 2), tile_coding(7, 5, 3, 2)]
    one_row = method in ("importance_sampling", "batch_td")
    features = data.draw(st.sampled_from([None, several[0]] if one_row else [None, *several]))
    found = qtab.estimate_values(
        WALK,
        data.draw(st.sampled_from(["random", LEAN])),
        method=method,
        episodes=4,
        env_kwargs={"states": 7},
        features=features,
        discount=data.draw(st.sampled_from([0.0, 0.9, 1.0])),
        initial_value=data.draw(st.sampled_from([0.0] if method == "lstd" else [0.0, 0.5])),
        max_episode_steps=data.draw(st.sampled_from([None, 20])),
        on_truncation=data.draw(st.sampled_from(["bootstrap", "terminate"])),
        bit_generator=data.draw(st.sampled_from(["PCG64", "MT19937"])),
        seeds=[data.draw(st.integers(0, 1000))],
        **options,
    )
    assert found.verify().equal


@pytest.mark.parametrize("method", ["td", "monte_carlo", "batch_td"])
def test_averages_come_near_the_exact_values(method: Any) -> None:
    env_kwargs = {"states": 5, "left_reward": 0.0}
    options: dict[str, Any] = {"learning_rate": 0.02, "initial_value": 0.5} if method == "td" else {}
    episodes = 1000 if method == "td" else 50
    found = qtab.estimate_values(
        WALK, "random", method=method, episodes=episodes, record=episodes, seeds=100, env_kwargs=env_kwargs, **options
    )
    exact = qtab.policy_values(WALK, "random", env_kwargs=env_kwargs).values
    # States that no episode has visited keep their initial values.
    bias = 0.01 if method == "batch_td" else 0.0
    assert (np.abs(found.mean - exact) < bias + 4.5 * found.standard_error).all()


def test_blackjack_off_policy_agrees_with_the_exact_values() -> None:
    def sticks(hand: tuple[int, int, int]) -> int:
        return int(hand[0] < 20)

    true_values = qtab.policy_values("Blackjack-v1", sticks, env_kwargs={"sab": True})
    for weighted in (True, False):
        found = qtab.estimate_values(
            "Blackjack-v1",
            sticks,
            method="importance_sampling",
            weighted=weighted,
            behavior="random",
            episodes=20_000,
            record=20_000,
            seeds=10,
            env_kwargs={"sab": True},
        )
        # The states that many episodes pass through: the dealer shows a ten.
        states = np.s_[12:20, 10, 0]
        error = np.abs(found.mean - true_values.values)[states]
        assert (error < 4.5 * found.standard_error[states]).all()


def test_td_finds_lower_errors_than_monte_carlo_on_the_random_walk() -> None:
    true_values = qtab.policy_values(WALK, "random")
    monte_carlo = qtab.estimate_values(WALK, "random", method="monte_carlo", learning_rate=0.05, episodes=50, seeds=50)
    td = qtab.estimate_values(
        WALK, "random", method="td_lambda", trace_decay=0.8, learning_rate=0.1, episodes=50, seeds=50
    )
    assert td.rms_error(true_values).mean(axis=0)[-1] < monte_carlo.rms_error(true_values).mean(axis=0)[-1]


def test_threads_and_the_other_seeds_do_not_change_a_run() -> None:
    one = qtab.estimate_values(WALK, "random", seeds=[7], learning_rate=0.1, threads=1)
    many = qtab.estimate_values(WALK, "random", seeds=range(9), learning_rate=0.1, threads=3, record=[0, 50])
    assert np.array_equal(one.weights[0, [49, 99]], many.weights[7, 1:])
    assert many.episodes.tolist() == [0, 50, 100]
    assert not many.values_after(0).any()


def test_an_environment_in_python_is_stepped_there() -> None:
    class Corridor(gym.Env[Any, Any]):
        observation_space = gym.spaces.Discrete(3)
        action_space = gym.spaces.Discrete(2)
        state = 0

        def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[int, dict[str, Any]]:
            super().reset(seed=seed)
            self.state = 0
            return 0, {}

        def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
            self.state += action
            return min(self.state, 2), -1.0, self.state > 2, False, {}

    found = qtab.estimate_values(Corridor, lambda state: 1, method="monte_carlo", episodes=3)
    assert found.values.tolist() == [[-3.0, -2.0, -1.0]]
    random = qtab.estimate_values(Corridor(), "random", learning_rate=0.5, episodes=5)
    assert verify_values(random, None, None, gym.wrappers.TimeLimit(Corridor(), 10_000)).equal
    with pytest.raises(ValueError, match="seeds must be one seed for an environment that is stepped in Python, got 2"):
        qtab.estimate_values(Corridor, "random", seeds=2)


def test_a_run_brings_its_discretizer() -> None:
    run = qtab.train("MountainCar-v0", seed=0, episodes=50)
    found = qtab.estimate_values("MountainCar-v0", run, episodes=5, learning_rate=0.1)
    assert found.shape == (19, 15)
    assert found.verify().equal


def test_estimates_are_saved_and_loaded(tmp_path: Any) -> None:
    found = qtab.estimate_values(WALK, "random", seeds=2, episodes=3, learning_rate=0.1)
    path = tmp_path / "values.npz"
    found.save(path)
    again = qtab.ValueEstimates.load(path)
    assert (again.settings, again.seeds, repr(again)) == (found.settings, found.seeds, repr(found))
    assert np.array_equal(again.weights, found.weights)
    with pytest.raises(ValueError, match="estimates from a file cannot be verified"):
        again.verify()
    path.write_bytes(b"no file")
    with pytest.raises(ValueError, match="not a file of value estimates"):
        qtab.ValueEstimates.load(path)


def test_pictures_and_tables_of_estimates(tmp_path: Any) -> None:
    found = qtab.estimate_values(WALK, "random", seeds=3, episodes=3, learning_rate=0.1)
    assert "<table" in found._repr_html_()
    assert repr(found) == "<ValueEstimates of qtab/RandomWalk-v0: td, 19 states, 3 runs of 3 episodes>"
    assert len(found.plot(true_values=np.zeros(19)).lines) == 2
    blackjack = qtab.estimate_values("Blackjack-v1", "random", episodes=3)
    labels = {text.get_text() for text in blackjack.plot().texts}
    assert {"usable ace", "no usable ace"} <= labels
    blackjack.save(tmp_path / "values.npz")
    ax = qtab.ValueEstimates.load(tmp_path / "values.npz").plot()  # without the observations
    assert len(ax.images) == 1
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("dealer's card", "player's sum")
    assert ax.get_title() == "Blackjack-v1: values by td, usable ace = yes"


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"method": "td0"}, ValueError, r"method must be one of .*, got 'td0' \(did you mean 'td'\?\)"),
        ({"learning_rate": 1.5}, ValueError, r"learning_rate must lie in \[0, 1\] for a table, got 1.5"),
        ({"learning_rate": -0.1}, ValueError, r"learning_rate must lie in \[0, 2\], got -0.1"),
        ({"method": "td_lambda", "trace_decay": 0.5}, ValueError, "learning_rate must be given for method 'td_lambda'"),
        ({"method": "n_step_td"}, ValueError, "n_steps must be given for method 'n_step_td', got None"),
        ({"method": "n_step_td", "n_steps": 0}, ValueError, "n_steps must be an integer of at least 1, got 0"),
        ({"n_steps": 3}, ValueError, "n_steps applies to method 'n_step_td', not to 'td', got 3"),
        (
            {"method": "td_lambda", "learning_rate": 0.1, "trace_decay": 2},
            ValueError,
            r"trace_decay must lie in \[0, 1\], got 2",
        ),
        ({"method": "batch_td", "learning_rate": 0.1}, ValueError, "learning_rate must be None for method 'batch_td'"),
        ({"method": "importance_sampling"}, ValueError, "behavior must be given for method 'importance_sampling'"),
        ({"behavior": "random"}, ValueError, "behavior applies to method 'importance_sampling', .*, not to 'td'"),
        (
            {"method": "importance_sampling", "behavior": np.zeros(19, int)},
            ValueError,
            "behavior must cover policy: it never takes action 1 in row 0, which policy takes with probability 0.5",
        ),
        ({"policy": np.zeros((18, 2))}, ValueError, r"policy must have the shape \(19,\) of actions"),
        ({"policy": np.full((19, 2), 0.4)}, ValueError, "policy must sum to 1 in every state, got 0.8"),
        ({"features": [0, 1]}, ValueError, "features must have a row of numbers for each of the 19 states"),
        ({"features": np.full(19, 10**12)}, ValueError, "^features must hold numbers from 0 to 2147483647, got 10"),
        ({"features": np.full(19, -1)}, ValueError, "^features must hold numbers from 0 to 2147483647, got -1$"),
        ({"features": np.zeros(19)}, TypeError, "features must be None or an array of integers"),
        (
            {"method": "batch_td", "features": tile_coding(19, 4, 2, 1)},
            ValueError,
            "features must have one active row for method 'batch_td', got 2",
        ),
        ({"record": [101]}, ValueError, "record must be an integer from 0 to 100, got 101"),
        ({"episodes": 10**15}, MemoryError, "record= keeps fewer"),
        ({"env": 3}, TypeError, "env must be an environment id"),
        ({"discount": 1.5}, ValueError, r"discount must lie in \[0, 1\], got 1.5"),
        ({"epsiodes": 1}, TypeError, "did you mean 'episodes'"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(changes: dict[str, Any], error: type[Exception], message: str) -> None:
    arguments: dict[str, Any] = {"env": WALK, "policy": "random", **changes}
    with pytest.raises(error, match=message):
        qtab.estimate_values(**arguments)


def test_values_that_overflow_are_an_error_with_the_seed() -> None:
    with pytest.raises(OverflowError, match="the values diverged in episode"):
        qtab.estimate_values(
            WALK, "random", method="td_lambda", trace_decay=1.0, learning_rate=1.0, episodes=1000, record=1000
        )


def test_batch_td_without_an_end_is_an_error_unless_it_is_discounted() -> None:
    arguments: dict[str, Any] = {"method": "batch_td", "episodes": 3, "max_episode_steps": 20}
    with pytest.raises(OverflowError, match="from which no episode ends have no limit; a discount below 1 helps"):
        qtab.estimate_values("CliffWalking-v1", "random", **arguments)
    assert qtab.estimate_values("CliffWalking-v1", "random", discount=0.9, **arguments).verify().equal


def test_features_of_numbered_states() -> None:
    assert state_aggregation(5, 2).ravel().tolist() == [0, 0, 1, 1, 2]
    assert tile_coding(6, 3, 2, 1).tolist() == [[0, 3], [0, 3], [0, 4], [1, 4], [1, 4], [1, 5]]
    with pytest.raises(ValueError, match="offset must shift the 4 tilings by less than the width 3 in all"):
        tile_coding(6, 3, 4, 1)


def test_only_what_was_recorded_is_verified() -> None:
    found = qtab.estimate_values(WALK, "random", episodes=20, record=10)
    with pytest.raises(ValueError, match=r"episodes must be one of those that were recorded, \[10, 20\], got 5"):
        found.verify(episodes=5)


def test_batch_td_settles_where_all_rewards_are_zero() -> None:
    # The values fall to 0, where the smallest numbers of float64 once went round in circles.
    env_kwargs = {"states": 5, "left_reward": 0.0, "right_reward": 0.0}
    found = qtab.estimate_values(
        WALK, "random", method="batch_td", initial_value=0.5, episodes=3, seeds=20, env_kwargs=env_kwargs
    )
    visited = found.values != 0.5
    assert visited.any()
    assert np.abs(found.values[visited]).max() < 1e-10
