"""Runs on an environment, compared with the optimum of the table that ``qtab.tabulate`` made of it."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.planning.tabulated_runs import on_table
from support.environments.errand import SETTINGS, Errand, ErrandClass
from support.environments.own.gymnasium_class import Corridor

LIMIT = 200


def limited(env: gym.Env[Any, Any]) -> gym.Env[Any, Any]:
    return gym.wrappers.TimeLimit(env, LIMIT)


@pytest.fixture(scope="module")
def table() -> qtab.TabulatedEnv:
    return qtab.tabulate(limited(Errand()))


@pytest.fixture(scope="module")
def best(table: qtab.TabulatedEnv) -> qtab.Optimum:
    return qtab.optimum(table)


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"algorithm": "double_q_learning"},
        {"max_rows": 80},
        {"discretizer": "tiles", "tilings": 4, "tiles": (3, 3, 2)},
        {"algorithm": "actor_critic", "epsilon": None, "epsilon_schedule": None},
        {"action_mask": lambda observation: [1, 1, 1, observation[0] > 0]},
    ],
    ids=["table", "two tables", "assigned rows", "tiles", "preferences", "masks"],
)
def test_the_greedy_return_is_that_of_an_episode(best: qtab.Optimum, settings: dict[str, Any]) -> None:
    given = {name: value for name, value in {**SETTINGS, **settings}.items() if value is not None}
    if "discretizer" in settings:  # tiles need a Box
        env: Any = gym.wrappers.TransformObservation(
            Errand(), lambda seen: np.array(seen, np.float32), gym.spaces.Box(0.0, 5.0, (3,))
        )
        with pytest.raises(ValueError, match="without a wrapper"):
            best.gap(qtab.train(limited(env), seed=1, episodes=20, **given))
        return
    for episodes in (30, 300):
        run = qtab.train(limited(Errand()), seed=1, episodes=episodes, **given)
        [played] = qtab.evaluate(run, 1, seed=0, env=limited(Errand())).returns
        gap = best.gap(run)
        assert gap.greedy_return == pytest.approx(played, abs=1e-9)
        assert gap.optimum == best.expected_return == pytest.approx(-15.0)
        assert gap.final_return == run.episode_returns[-100:].mean()


def test_a_time_aware_run_is_compared_step_by_step(best: qtab.Optimum) -> None:
    run = qtab.train(limited(Errand()), seed=1, episodes=2000, time_aware=True, **SETTINGS)
    [played] = qtab.evaluate(run, 1, seed=0, env=limited(Errand())).returns
    assert best.gap(run).greedy_return == pytest.approx(played, abs=1e-9)


def test_many_runs_are_compared_at_once(best: qtab.Optimum) -> None:
    runs = qtab.train_many(lambda: limited(ErrandClass()), seeds=3, episodes=300, tables=True, threads=1, **SETTINGS)
    best_of_class = qtab.optimum(qtab.tabulate(limited(ErrandClass())))
    gap = best_of_class.gap(runs)
    assert gap.greedy_return.tolist() == [best_of_class.gap(run).greedy_return for run in runs]
    with pytest.raises(ValueError, match="run must have env 'TabulatedEnv' as this optimum has, got 'ErrandClass'"):
        best.gap(runs)


def test_policy_values_take_a_run_on_the_environment(table: qtab.TabulatedEnv) -> None:
    run = qtab.train(limited(Errand()), seed=0, episodes=400, **SETTINGS)
    values = qtab.policy_values(table, run, discount=0.95)
    assert values.values.shape == (len(table.states),)
    assert values.expected_return == pytest.approx(-sum(0.95**step for step in range(15)))


def test_an_id_with_its_package_is_that_environment() -> None:
    gym.register("tests/Errand-v0", "support.environments.errand:Errand", max_episode_steps=LIMIT)
    try:
        run = qtab.train("support.environments.errand:tests/Errand-v0", seed=1, episodes=300, **SETTINGS)
        table = qtab.tabulate(gym.make("tests/Errand-v0"))
        of_object = qtab.train(gym.make("tests/Errand-v0"), seed=1, episodes=300, **SETTINGS)
        values = [qtab.policy_values(table, one, discount=0.95).values for one in (run, of_object)]
        assert values[0].tobytes() == values[1].tobytes()
        best = qtab.optimum(table)
        assert best.gap(run).greedy_return == best.gap(of_object).greedy_return
        assert qtab.plots.difference(run, best) is not None
    finally:
        del gym.registry["tests/Errand-v0"]


def test_the_picture_of_the_difference_has_the_costs_of_the_run(best: qtab.Optimum) -> None:
    pytest.importorskip("matplotlib")
    from matplotlib import pyplot as plt

    run = qtab.train(limited(Errand()), seed=0, episodes=60, **SETTINGS)
    ax = qtab.plots.difference(run, best)
    assert ax.get_title(loc="left").startswith("Errand: cost against an optimal policy")
    plt.close("all")


class BoxCorridor(Corridor):
    """A corridor without chance or coins, whose observation is the place as a Box."""

    def __init__(self) -> None:
        super().__init__(slip=0.0)
        self.observation_space: Any = gym.spaces.Box(0.0, 4.0, (1,), np.float64)

    def reset(self, **given: Any) -> Any:
        _, info = super().reset(**given)
        self.coins = []
        return np.array([float(self.place)]), info

    def step(self, action: int) -> Any:
        place, *others = super().step(action)
        return np.array([float(place)]), *others


@pytest.mark.parametrize("initial_q", [0.0, 1.0])
@pytest.mark.parametrize("algorithm", ["q_learning", "double_q_learning"])
def test_the_values_of_fourier_features_are_sums_over_all_weights(algorithm: Any, initial_q: float) -> None:
    settings: Any = {"discretizer": "fourier", "learning_rate": 0.05, "discount": 1.0, "initial_q": initial_q}
    runs = [
        qtab.train(limited(BoxCorridor()), algorithm=algorithm, seed=1, episodes=episodes, progress=False, **settings)
        for episodes in (1, 300)
    ]
    table = qtab.tabulate(limited(BoxCorridor()))
    best = qtab.optimum(table)
    for run in runs:
        [played] = qtab.evaluate(run, 1, seed=0, env=limited(BoxCorridor())).returns
        assert best.gap(run).greedy_return == pytest.approx(played)
        on_states = on_table(run, table)
        observations = np.array([[float(place[0])] for place in table.observations])
        assert np.array_equal(on_states.tables.sum(axis=0), run.q_values(observations))
    assert best.gap(runs[1]).greedy_return == best.expected_return == pytest.approx(-4.0)
    values = qtab.policy_values(table, runs[1])
    assert values.expected_return == pytest.approx(-4.0)
    many = qtab.train_many(
        lambda: limited(BoxCorridor()), algorithm=algorithm, seeds=2, episodes=50, tables=True, threads=1, **settings
    )
    assert best.gap(many).greedy_return.tolist() == [best.gap(run).greedy_return for run in many]
    matplotlib = pytest.importorskip("matplotlib.pyplot")
    qtab.plots.difference(runs[1], best)
    matplotlib.close("all")


def test_a_diagnosis_knows_the_goal_from_the_table(best: qtab.Optimum) -> None:
    env = limited(Errand())
    failed = qtab.diagnose(qtab.train(env, seed=0, episodes=60, **SETTINGS), best, env=env)
    assert failed.solved is False
    assert failed["not solved"].evidence["greedy policy"] == pytest.approx(-LIMIT)
    assert "greedy loop" in failed
    assert qtab.diagnose(qtab.train(env, seed=0, episodes=400, **SETTINGS), best, env=env).solved is True


def test_states_that_share_an_observation_have_the_same_policy() -> None:
    env = limited(Corridor())
    table = qtab.tabulate(env)
    assert len(table.states) > env.observation_space.n  # type: ignore[attr-defined]
    run = qtab.train(env, seed=0, episodes=500)
    exact = qtab.optimum(table).gap(run)
    played = qtab.evaluate(run, 4000, seed=0, env=env)
    assert exact.greedy_return == pytest.approx(played.mean_return, abs=4 * played.standard_error)


def test_a_mask_without_any_action_in_terminal_states_is_not_asked_for() -> None:
    env = limited(Corridor())
    run = qtab.train(env, seed=0, episodes=500, action_mask=lambda observation: [observation != 4] * 2)
    unmasked = qtab.train(env, seed=0, episodes=500)
    best = qtab.optimum(qtab.tabulate(env))
    assert best.gap(run).greedy_return == best.gap(unmasked).greedy_return


class OneWay(Errand):
    """Its action mask forbids the way back to the left, which the transition would allow."""

    def action_mask(self, state: Any) -> Any:
        return np.array([True, True, True, False])


def test_a_run_that_takes_unavailable_actions_is_refused() -> None:
    table = qtab.tabulate(limited(OneWay()))
    best = qtab.optimum(table)
    settings: dict[str, Any] = {"seed": 1, "episodes": 300, **SETTINGS}
    masked = qtab.train(limited(OneWay()), action_mask=True, **settings)
    [played] = qtab.evaluate(masked, 1, seed=0, env=limited(OneWay())).returns
    assert best.gap(masked).greedy_return == pytest.approx(played)
    several = qtab.train_many(lambda: limited(OneWay()), seeds=2, episodes=300, action_mask=True, **SETTINGS)
    assert several.action_masks is None  # they are kept with the tables only
    assert best.gap(several).optimum == best.gap(masked).optimum
    run = qtab.train(limited(OneWay()), **settings)
    expected = "^run must have action_mask=True, as the table leaves out unavailable actions, got False$"
    for call in (best.gap, lambda run: qtab.policy_values(table, run), lambda run: qtab.diagnose(run, best)):
        with pytest.raises(ValueError, match=expected):
            call(run)


class Placed(OneWay):
    """Observes its place as numbers of a Box, which tile coding takes."""

    observation_space: Any = gym.spaces.Box(0.0, 8.0, (3,), np.float32)

    def observe(self, state: Any) -> Any:
        return np.array(state, np.float32)


def test_masks_are_those_of_the_table_where_a_discretizer_keeps_none() -> None:
    settings: dict[str, Any] = {"discretizer": "tiles", "tilings": 4, "tiles": 5, "episodes": 600, "preset": None}
    best = qtab.optimum(qtab.tabulate(limited(Placed())))
    run = qtab.train(limited(Placed()), action_mask=True, seed=0, **settings)
    assert run.action_masks is None
    [played] = qtab.evaluate(run, 1, seed=0, env=limited(Placed())).returns
    assert best.gap(run).greedy_return == pytest.approx(played)
    several = qtab.train_many(lambda: limited(Placed()), seeds=[0, 1], action_mask=True, tables=True, **settings)
    assert best.gap(several).greedy_return[0] == best.gap(run).greedy_return


def test_the_table_of_toy_text_has_the_outcomes_of_unavailable_actions() -> None:
    env = gym.make("Taxi-v4")
    run = qtab.train(env, seed=0, episodes=20)
    ours, theirs = qtab.optimum(qtab.tabulate(env)), qtab.optimum("Taxi-v4")
    assert ours.gap(run).greedy_return == theirs.gap(run).greedy_return


def test_an_environment_with_other_arguments_is_refused(best: qtab.Optimum) -> None:
    run = qtab.train(limited(Errand(cost=2.0)), seed=0, episodes=10)
    expected = r"that the table was made of, got another one: its attribute cost was 1\.0, and is now 2\.0"
    with pytest.raises(ValueError, match=expected):
        best.gap(run)
    with pytest.raises(ValueError, match=expected):
        qtab.diagnose(run, best)


def test_another_time_limit_is_refused(best: qtab.Optimum) -> None:
    run = qtab.train(limited(Errand()), seed=0, episodes=10, max_episode_steps=50)
    with pytest.raises(ValueError, match="run must have max_episode_steps 200 as this optimum has, got 50"):
        best.gap(run)


def test_toy_text_is_compared_with_its_tabulated_table() -> None:
    run = qtab.train("FrozenLake-v1", seed=0, preset="solved")
    ours, theirs = qtab.optimum(qtab.tabulate(gym.make("FrozenLake-v1"))), qtab.optimum("FrozenLake-v1")
    assert ours.gap(run).greedy_return == theirs.gap(run).greedy_return
