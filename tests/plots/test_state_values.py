"""Pictures of values show what was learned, and name it: state values, action values or preferences."""

from typing import Any

import numpy as np
import pytest

import qtab
from qtab import plots
from qtab.config.options import PREFERENCES, WITH_STATE_VALUES

LAKE: dict[str, Any] = {"env": "FrozenLake-v1", "episodes": 200, "seed": 0}


def mesh(ax: Any) -> Any:
    return [one for one in ax.collections if type(one).__name__ == "QuadMesh"][-1]


def shown(ax: Any) -> Any:
    return np.ma.filled(mesh(ax).get_array().astype(float), np.nan).ravel()


def label(ax: Any) -> str:
    return str(mesh(ax).colorbar.ax.get_ylabel())


@pytest.mark.parametrize("algorithm", WITH_STATE_VALUES)
def test_learned_state_values_are_drawn_and_not_the_preferences(algorithm: Any) -> None:
    run = qtab.train(algorithm=algorithm, **LAKE)
    ax = plots.values(run)
    assert label(ax) == "value, v(s)"
    known = np.isfinite(shown(ax))
    values = np.array([run.values(state) for state in range(16)])
    assert known.any()
    assert shown(ax)[known].tolist() == values[known].tolist()
    assert not np.any(values[~known])
    many = qtab.train_many(LAKE["env"], 3, episodes=200, algorithm=algorithm, tables=True)
    single = [many[index] for index in range(3)]
    means = np.array([[run.values(state) for state in range(16)] for run in single])
    both = np.isfinite(shown(plots.values(many))) & np.all([np.isfinite(shown(plots.values(run))) for run in single], 0)
    assert shown(plots.values(many))[both] == pytest.approx(means.mean(axis=0)[both])


@pytest.mark.parametrize("algorithm", [name for name in PREFERENCES if name not in WITH_STATE_VALUES])
def test_preferences_alone_are_named(algorithm: Any) -> None:
    env = {"env": "qtab/KArmedBandit-v0"} if algorithm == "gradient_bandit" else {}
    run = qtab.train(algorithm=algorithm, **LAKE | env)
    ax = plots.values(run)
    assert label(ax).replace("\n", " ") == "largest preference, max$_a$ H(s, a)"
    assert np.nanmax(shown(ax)) == run.tables[0].max()
    assert "Preferences" in [ax.get_title("left") for ax in plots.overview(run).axes]
    if algorithm != "gradient_bandit":
        with pytest.raises(ValueError, match="runs that learned values or only runs that learned preferences"):
            plots.values([run, qtab.train(**LAKE)])


def test_values_of_several_kinds_have_a_common_name() -> None:
    q, critic = (
        qtab.train(**LAKE),
        qtab.train(algorithm="actor_critic", **LAKE, discount=qtab.train(**LAKE).config.discount),
    )
    assert label(plots.values(q)) == "value, max$_a$ Q(s, a)"
    assert plots.values([q, critic]).figure.axes[-1].get_ylabel() == "value"


def test_runs_of_different_discounts_have_scales_of_their_own() -> None:
    cliff: dict[str, Any] = {"env": "CliffWalking-v1", "episodes": 100, "seed": 0}
    runs = [qtab.train(discount=discount, **cliff) for discount in (0.5, 1.0)]
    first, second = plots.values(runs).figure.axes[:2]
    for ax, run in ((first, runs[0]), (second, runs[1])):
        assert mesh(ax).norm.vmin == np.nanmin(shown(plots.values(run)))
        assert label(ax) == "value, max$_a$ Q(s, a)"
    assert mesh(first).norm.vmin > 0.5 * mesh(second).norm.vmin
    same = plots.values([runs[0], qtab.train(**{**cliff, "seed": 1}, discount=0.5)]).figure.axes[:2]
    assert len({mesh(ax).norm for ax in same}) == 1


def test_costs_of_numbered_states_without_a_map() -> None:
    outcomes = [[(1.0, 1, 0.0, False)], [(1.0, 0, -1.0, True)]]
    env = qtab.TabularEnv({0: dict(enumerate(outcomes)), 1: dict(enumerate(outcomes[::-1]))}, [1.0, 0.0])
    best = qtab.optimum(env, max_episode_steps=1)
    worst = qtab.train(env, episodes=1, max_episode_steps=1, seed=0, learning_rate=0.0, initial_q=-best.q_values)
    assert shown(plots.difference(worst, best)).ravel().tolist() == [1.0, 1.0]


@pytest.mark.parametrize("elsewhere", [0.0, 1e10])
def test_rewards_that_cancel_tie_and_large_values_elsewhere_hide_no_cost(elsewhere: float) -> None:
    """In state 0, the rewards 0.1, 0.2 and -0.3 add up to almost 0, the value of the other action."""
    assert 0.1 + (0.2 - 0.3) > 0.0
    rows = [(1, 0.1), (2, 0.2), (4, -0.3), (4, -elsewhere), (4, 0.0)]
    table = {state: {key: [(1.0, to, reward, to == 4)] for key in range(2)} for state, (to, reward) in enumerate(rows)}
    table[0][1] = [(1.0, 4, 0.0, True)]
    table[4][1] = [(1.0, 4, -1.0, True)]
    env = qtab.TabularEnv(table, np.eye(1, 5)[0])
    second = np.tile([0.0, 1.0], (5, 1))
    run = qtab.train(env, episodes=1, max_episode_steps=9, seed=0, learning_rate=0.0, initial_q=second)
    cost = shown(plots.difference(run, qtab.optimum(env, max_episode_steps=9))).ravel()
    assert cost[np.isfinite(cost)].tolist() == [1.0]
