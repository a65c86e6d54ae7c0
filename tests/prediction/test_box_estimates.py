"""Estimated values over the observations of a Box: files, pictures, and what is refused."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import qtab
from support.learners.box_prediction import CAR, FAST, PENDULUM, POLE, TILES, with_the_velocity


def test_estimates_are_saved_with_what_divides_the_observations(tmp_path: Any) -> None:
    path, observations = tmp_path / "values.npz", np.array([[-0.5, 0.0], [0.3, 0.05]], np.float32)
    several: list[dict[str, Any]] = [TILES, {**TILES, "hashed_rows": 90}, {"discretizer": "bins", "bins": (4, 3)}, {}]
    for cells in [*several, {"discretizer": "edges", "edges": [[-0.5], [0.0]]}]:
        for policy in ("random", with_the_velocity):
            found = qtab.estimate_values(CAR, policy, seeds=2, **FAST, **cells)
            found.save(path)
            again = qtab.ValueEstimates.load(path)
            assert np.array_equal(again.weights, found.weights)
            assert np.array_equal(again.value(observations), found.value(observations))
            assert repr(again) == repr(found)
            with pytest.raises(ValueError, match="estimates from a file cannot be verified"):
                again.verify()


def test_damaged_files_are_refused(tmp_path: Any) -> None:
    path = tmp_path / "values.npz"
    qtab.estimate_values(CAR, with_the_velocity, **FAST, **TILES).save(path)
    with np.load(path) as file:
        arrays = dict(file)
    about = str(arrays["about"])
    damaged = [
        {"weights": arrays["weights"][..., 1:]},
        {"discretizer_low": arrays["discretizer_low"][:1]},
        {"about": about.replace('"format": 2', '"format": 4')},
        {"about": about.replace('"format": 2', '"format": 1')},
        {"about": about.replace('"discretizer"', '"other"', 1)},
        {"about": about.replace('"tilings": 4', '"tilings": "x"')},
    ]
    for changes in damaged:
        np.savez(path, **{**arrays, **changes})
        with pytest.raises(ValueError, match="not a file of value estimates"):
            qtab.ValueEstimates.load(path)


def test_pictures_of_values_over_observations() -> None:
    tiles = qtab.estimate_values(CAR, "random", seeds=2, **FAST, **TILES)
    assert repr(tiles) == "<ValueEstimates of MountainCar-v0: td, 4 of 100 features, 2 runs of 3 episodes>"
    assert "4 of 100 features" in tiles._repr_html_()
    assert "<svg" not in tiles._repr_html_()
    ax = tiles.plot()
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("position (m)", "velocity (m/step)")
    mesh: Any = next(artist for artist in ax.collections if hasattr(artist, "get_coordinates"))
    shown = mesh.get_array()
    assert shown.size > 10_000
    # Nothing is known of the fastest velocities, which random actions do not reach.
    assert np.isfinite(np.ma.filled(shown, np.nan)).any()
    cells = qtab.estimate_values(CAR, "random", **FAST)
    qtab.plots.values([tiles, cells, qtab.train(CAR, seed=0, episodes=1)])
    with pytest.raises(TypeError, match="run must be a Run, Runs or an Optimum"):
        qtab.plots.policy(tiles)  # type: ignore[arg-type]


def test_pictures_of_numbered_states_from_a_file_are_refused(tmp_path: Any) -> None:
    path = tmp_path / "values.npz"
    qtab.estimate_values("FrozenLake-v1", "random", episodes=2).save(path)
    again = qtab.ValueEstimates.load(path)
    with pytest.raises(ValueError, match="run must be estimates with their discretizer, got those of numbered states"):
        qtab.plots.values(again)
    with pytest.raises(ValueError, match="value needs the observations of the states, which are not in the file"):
        again.value(0)


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"method": "batch_td"}, ValueError, "discretizer must be 'round', 'bins' or 'edges' for method 'batch_td'"),
        ({"method": "batch_td", "tilings": 1}, ValueError, "discretizer must be 'round', 'bins' or 'edges' for method"),
        (
            {"method": "importance_sampling", "behavior": "random"},
            ValueError,
            "discretizer must be 'round', 'bins' or 'edges' for method 'importance_sampling'",
        ),
        ({"method": "monte_carlo", "first_visit": True}, ValueError, "first_visit must be False for discretizer 'tile"),
        ({"features": np.zeros(100, int)}, ValueError, "features must be None for discretizer 'tiles'"),
        ({"policy": np.zeros(100, int)}, ValueError, "policy must be a function, a run, an optimum or 'random' for ti"),
        ({"policy": "greedy"}, ValueError, "policy must be 'random' or a policy, got 'greedy'"),
        ({"policy": lambda _: 3}, ValueError, r"policy must return actions from 0 to 2, got 3 for the observation \["),
        (
            {"policy": lambda _: True},
            TypeError,
            "policy must return the number of an action or 3 probabilities, got Tr",
        ),
        (
            {"policy": lambda _: None},
            TypeError,
            "policy must return the number of an action or 3 probabilities, got No",
        ),
        ({"policy": lambda _: [0.5, 0.5]}, ValueError, r"policy must return the number .* got \[0.5, 0.5\] for"),
        (
            {"policy": lambda _: [0.5, 0.4, 0]},
            ValueError,
            "policy must return probabilities of at least 0 that sum to 1",
        ),
        ({"policy": lambda _: [2, -1, 0]}, ValueError, "policy must return probabilities of at least 0 that sum to 1"),
        ({"policy": lambda at: at[2]}, IndexError, "index 2 is out of bounds"),
        ({"learning_rate": 2.5}, ValueError, r"learning_rate must lie in \[0, 2\]"),
        ({"tilings": 33}, ValueError, "tilings must"),
        ({"bins": 3}, ValueError, "bins applies to discretizer 'bins', not to 'tiles', got "),
        ({"discretizer": "tile"}, ValueError, r"discretizer must be .*, got 'tile' \(did you mean 'tiles'\?\)"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(changes: dict[str, Any], error: type[Exception], message: str) -> None:
    rate = {} if "method" in changes else {"learning_rate": 0.1}
    arguments: dict[str, Any] = {"env": CAR, "policy": "random", "episodes": 2, **rate, **TILES, **changes}
    with pytest.raises(error, match=message):
        qtab.estimate_values(**arguments)


def test_policies_that_do_not_fit_each_other_or_the_task_are_refused() -> None:
    with pytest.raises(ValueError, match="behavior must cover policy: it never takes action 0 at the observation"):
        qtab.estimate_values(CAR, with_the_velocity, method="importance_sampling", behavior=lambda _: 2, episodes=1)
    run = qtab.train(POLE, seed=0, episodes=2)
    with pytest.raises(ValueError, match=r"policy must be a run with observations of shape \(2,\) and dtype float32"):
        qtab.estimate_values(CAR, run, episodes=1, **TILES)
    torques = qtab.train(PENDULUM, seed=0, episodes=1, actions=3)
    with pytest.raises(ValueError, match="policy must be a run with the actions <Actions: 5"):
        qtab.estimate_values(PENDULUM, torques, episodes=1, actions=5, **TILES)
    tiles = qtab.estimate_values(CAR, "random", **FAST, **TILES)
    reads: list[Callable[[], object]] = [lambda: tiles.values, lambda: tiles.mean, lambda: tiles.rms_error([0.0])]
    for read in reads:
        with pytest.raises(
            ValueError, match=r"values need cells, which tile coding does not have; value\(observation\)"
        ):
            read()
    with pytest.raises(TypeError, match="true_values must be an array where observations is None, got a function"):
        tiles.rms_error(lambda _: 0.0)
    with pytest.raises(ValueError, match=r"true_values must have the shape \(2,\) of the observations, got \(1,\)"):
        tiles.rms_error([0.0], observations=[[0.0, 0.0], [0.1, 0.0]])
    with pytest.raises(ValueError, match="observations must hold several observations"):
        tiles.rms_error([0.0], observations=[0.0, 0.0])


def test_an_exception_of_a_policy_names_the_seed_and_ends_all_runs() -> None:
    calls = 0

    def policy(_: Any) -> int:
        nonlocal calls
        calls += 1
        raise ZeroDivisionError("no policy")

    with pytest.raises(ZeroDivisionError, match="no policy") as raised:
        qtab.estimate_values(CAR, policy, seeds=[7, 8, 9], learning_rate=0.1)
    assert calls == 1
    assert getattr(raised.value, "__notes__", ["in the run with seed 7"]) == ["in the run with seed 7"]
