"""The article's run is diagnosed and led to a solved task; evidence, reports and bad input."""

import json
from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.results.rates import epsilons
from support.environments.gridworld import Room

LAKE = "FrozenLake-v1"


@pytest.fixture(scope="module")
def article() -> qtab.Run:
    return qtab.train("MountainCar-v0", seed=0)


@pytest.fixture(scope="module")
def diagnosis(article: qtab.Run) -> qtab.Diagnosis:
    return qtab.diagnose(article)


def test_the_articles_run_has_its_faults(article: qtab.Run, diagnosis: qtab.Diagnosis) -> None:
    assert diagnosis.names == ("not solved", "horizon", "grid too coarse", "exploration")
    solved = diagnosis["not solved"].evidence
    assert solved["last 100 training episodes"] == article.episode_returns[-100:].mean()
    assert solved["greedy policy"] == qtab.evaluate(article, 100, seed=0).mean_return
    assert solved["threshold"] == -110.0
    horizon = diagnosis["horizon"].evidence
    assert horizon["steps ahead"] == pytest.approx(10.0)
    assert horizon["weight of the goal at the start"] == 0.9**83
    assert diagnosis["grid too coarse"].evidence["cells"] == 19 * 15
    reached = article.episode_returns > -200
    assert diagnosis["exploration"].evidence["first episode that reaches it"] == int(np.argmax(reached))
    assert diagnosis["exploration"].evidence["second half"] == reached[2500:].mean()


def test_shares_are_shown_in_percent_and_stored_as_numbers(diagnosis: qtab.Diagnosis) -> None:
    grid = diagnosis["grid too coarse"]
    share = grid.evidence["share of steps that stay in their cell"]
    assert 0.6 < share < 0.7
    assert f"cells: 285; share of steps that stay in their cell: {100 * share:.3g} %\n" in str(grid)
    assert f"share of steps that stay in their cell: {100 * share:.3g} %" in grid._repr_html_()
    assert json.loads(json.dumps(dict(grid.evidence))) == grid.evidence


def test_closer_limits_are_nowhere_wider() -> None:
    low, high = np.array([-2.4, -20.0, -0.21, -20.0]), np.array([2.4, 20.0, 0.21, 20.0])
    settings: dict[str, Any] = {"discretizer": "bins", "bins": (3, 3, 6, 6), "low": tuple(low), "high": tuple(high)}
    found = qtab.diagnose(qtab.train("CartPole-v1", episodes=500, seed=0, **settings), seeds=0)["limits too wide"]
    (change,) = found.changes
    assert (np.array(change["low"]) >= low).all()
    assert (np.array(change["high"]) <= high).all()
    assert change["high"][0] == 2.4  # the bounds of the space are wider
    assert change["high"][1] < 10
    assert "bins of cart velocity: 3; bins that its values cover:" in str(found)
    assert "The values of cart velocity lie within" in found.meaning


@pytest.mark.slow
def test_the_numbers_of_mountain_car_are_those_of_the_search(article: qtab.Run) -> None:
    from qtab.diagnosis import facts
    from qtab.envs.metadata.goals import BEST_KNOWN_MOUNTAIN_CAR

    optimum = qtab.optimum(article)
    assert optimum.search is not None
    assert (optimum.search.steps.min(), optimum.search.steps.max()) == (
        facts.SHORTEST_MOUNTAIN_CAR,
        facts.LONGEST_MOUNTAIN_CAR,
    )
    assert optimum.expected_return == pytest.approx(BEST_KNOWN_MOUNTAIN_CAR, abs=5e-4)
    mixed = qtab.diagnose(article, optimum)["grid too coarse"].evidence
    assert 0.0 < mixed["share of states whose best action is not their cell's"] < 0.5


@pytest.mark.slow
def test_following_the_advice_solves_the_articles_task(article: qtab.Run) -> None:
    run, returns = article, []
    for _ in range(4):
        found = qtab.diagnose(run, seeds=0)
        if found.solved:
            break
        trials = [trial for trial in found.what_if(2).results if "preset" not in trial.change]
        assert trials[0].comparison is not None
        assert trials[0].comparison.difference.estimate > 0
        returns.append(trials[0].returns.mean())
        run = qtab.train(config=run.config, **trials[0].change)
    assert found.solved
    assert run.episode_returns[-100:].mean() > -110
    assert returns == sorted(returns)


def test_what_if_compares_each_change_over_the_same_seeds() -> None:
    run = qtab.train(LAKE, seed=0, epsilon=0.0, episodes=1000)
    tried = qtab.diagnose(run).what_if(seeds=[3, 4, 5, 6])
    assert tried.seeds == (3, 4, 5, 6)
    assert tried.returns.tolist() == qtab.train_many(config=run.config, seeds=[3, 4, 5, 6]).final_returns().tolist()
    (trial,) = (trial for trial in tried.results if trial.finding == "exploration")
    changed = qtab.train_many(config=run.config, seeds=[3, 4, 5, 6], **trial.change)
    assert trial.returns.tolist() == changed.final_returns().tolist()
    assert trial.comparison is not None
    assert trial.comparison.difference.estimate == pytest.approx((trial.returns - tried.returns).mean())
    assert trial.comparison.difference.estimate > 0
    means = [trial.returns.mean() for trial in tried.results]
    assert means == sorted(means, reverse=True)
    assert tried.best is tried.results[0]
    lines = str(tried).splitlines()
    assert len(lines) == 3 + len(tried.results)
    assert "preset='solved'" in str(tried)
    assert tried._repr_html_().count("<tr>") == 2 + len(tried.results)


def test_a_diagnosis_prints_and_can_be_searched(diagnosis: qtab.Diagnosis) -> None:
    text = str(diagnosis)
    assert repr(diagnosis) == text
    assert text.splitlines()[0].endswith("not solved")
    for finding in diagnosis:
        assert finding.title in text
        assert finding.meaning in text
        assert finding.advice in text
    assert "Nothing to report on: divergence" in text
    assert diagnosis._repr_html_().count("<tr>") == 1 + len(diagnosis)
    assert "horizon" in diagnosis
    assert "coverage" not in diagnosis
    with pytest.raises(KeyError, match="no finding 'coverage'; there are not solved, horizon"):
        diagnosis["coverage"]


def test_visits_tell_untried_actions_from_values_that_stayed_the_same() -> None:
    settings: dict[str, Any] = {"initial_q": 0.0, "epsilon": 1.0, "epsilon_schedule": "constant", "episodes": 300}
    settings |= {"seed": 3}
    counted = qtab.diagnose(qtab.train(LAKE, visits=True, **settings), seeds=0)
    assert counted.run.visits is not None
    assert counted.facts.visited.tolist() == counted.run.visits.any(axis=1).tolist()
    assert "coverage" not in counted
    counted_anew = qtab.diagnose(qtab.train(LAKE, **settings), seeds=0)
    assert counted_anew.facts.visits is not None
    assert counted_anew.facts.visits.tobytes() == counted.run.visits.astype(np.int64).tobytes()
    guessed = qtab.diagnose(qtab.train(LAKE, backend="gymnasium", **settings), seeds=0)
    assert guessed["coverage"].title.endswith("or their values never changed.")


def test_preferences_are_diagnosed_without_the_checks_of_action_values() -> None:
    run = qtab.train(LAKE, algorithm="actor_critic", seed=1, episodes=300, max_episode_steps=60)
    diagnosis = qtab.diagnose(run, seeds=0)
    assert diagnosis.names == ("not solved",)
    # The policy is the softmax, of which the most likely actions are only a part: episodes are played, not computed.
    assert diagnosis["not solved"].evidence["greedy policy"] == qtab.evaluate(run, 100, seed=0).mean_return
    assert {"divergence", "coverage", "noisy values"} < set(diagnosis.not_made)
    assert "Not checked, as it learned preferences instead of action values" in str(diagnosis)


@pytest.mark.parametrize("algorithm", ["monte_carlo", "off_policy_monte_carlo", "differential_sarsa"])
def test_the_checks_compare_other_methods_with_random_actions(algorithm: Any) -> None:
    run = qtab.train(LAKE, algorithm=algorithm, seed=1, episodes=100, epsilon=0.0, max_episode_steps=30)
    found = qtab.diagnose(run, seeds=0)["exploration"]
    assert 0.0 < found.evidence["by random actions"] < 0.1


def test_more_seeds_than_fit_into_memory_are_refused_before_there_is_a_list_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    run = qtab.train(LAKE, seed=0, episodes=10)
    monkeypatch.setattr("qtab._utils.memory.memory_limit", lambda _: 20_000)
    with pytest.raises(MemoryError, match=r"^101 runs would take "):
        qtab.diagnose(run, seeds=100)


def test_other_seeds_give_the_rank() -> None:
    run = qtab.train(LAKE, preset="solved", episodes=500, seed=13)
    evidence = qtab.diagnose(run, seeds=40)["unlucky seed"].evidence
    others = qtab.train_many(config=run.config, seeds=[seed for seed in range(41) if seed != 13], tables=True)
    gap = qtab.optimum(run).gap(others)
    assert evidence["seeds"] == 41
    assert evidence["share of the others that solve it"] == np.mean(gap.greedy_return >= 0.7)
    assert "unlucky seed" not in qtab.diagnose(run, seeds=0)


def test_an_environment_in_python_is_diagnosed_by_what_the_run_holds() -> None:
    diagnosis = qtab.diagnose(qtab.train(Room(), seed=0, episodes=5))
    assert diagnosis.solved is None
    assert "exploration" in diagnosis.not_made
    assert "Not checked, as Rust cannot repeat this run" in str(diagnosis)
    changed = qtab.diagnose(qtab.train(Room(), seed=0, episodes=5, epsilon=0.5, epsilon_schedule="constant"))
    with pytest.raises(ValueError, match="what_if needs an environment with an id to make it again, and Room has none"):
        changed.what_if()


def test_a_table_without_an_id_is_diagnosed_by_what_the_run_holds() -> None:
    table = {0: {0: [(1.0, 1, 0.0, False)]}, 1: {0: [(1.0, 1, 1.0, True)]}}
    run = qtab.train(qtab.TabularEnv(table, [1.0, 0.0]), max_episode_steps=5, seed=0, episodes=5)
    assert run.config.backend == "rust"
    assert "exploration" in qtab.diagnose(run).not_made


@pytest.mark.parametrize(
    "settings",
    [
        {"exploration": "softmax"},
        {"algorithm": "double_q_learning"},
        {"algorithm": "n_step_sarsa", "discretizer": "tiles"},
        {"learning_rate_schedule": "visits"},
        {"epsilon_schedule": "exponential", "learning_rate_schedule": "exponential"},
        {"algorithm": "dyna_q", "episodes": 5},
        {"discretizer": "bins", "bins": (3, 3)},
        {"discretizer": "tiles", "hashed_rows": 50},
        {"episodes": 1},
    ],
)
def test_every_kind_of_run_is_diagnosed(settings: dict[str, Any]) -> None:
    run = qtab.train("MountainCar-v0", seed=0, **{"episodes": 20, **settings})
    assert qtab.diagnose(run, seeds=0).solved is False


def test_an_interrupted_run_is_diagnosed() -> None:
    run = qtab.train(LAKE, seed=0, episodes=500, callback=lambda progress: progress.episodes < 200)
    assert not run.completed
    assert qtab.diagnose(run).solved is False


def test_bad_arguments_are_named(article: qtab.Run) -> None:
    with pytest.raises(TypeError, match=r"run must be a Run, got 'run\.npz'; qtab\.load"):
        qtab.diagnose("run.npz")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="optimum must be an Optimum, got 3"):
        qtab.diagnose(article, 3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="run must have env 'FrozenLake-v1' as this optimum has"):
        qtab.diagnose(article, qtab.optimum(LAKE))
    with pytest.raises(ValueError, match="seeds must be an integer of at least 0, got -1"):
        qtab.diagnose(article, seeds=-1)
    with pytest.raises(ValueError, match="run must have a finished episode"):
        qtab.diagnose(replace(article, episode_returns=np.empty(0), completed=False))
    solved = qtab.diagnose(qtab.train("CliffWalking-v1", preset="solved", seed=0))
    with pytest.raises(ValueError, match="no finding advises a change"):
        solved.what_if()
    with pytest.raises(ValueError, match="seeds must be at least 2"):
        qtab.diagnose(article, seeds=0).what_if(1)


def test_an_extended_run_is_diagnosed_without_repeating_it() -> None:
    part = qtab.train(LAKE, seed=0, episodes=20, epsilon=0.0, learning_rate_schedule="linear")
    diagnosis = qtab.diagnose(qtab.resume(part, 40))
    assert diagnosis.reasons["noisy values"] == (
        "it was resumed with more episodes while a rate fell, and cannot be repeated"
    )


def test_the_rates_of_an_extended_run_are_those_that_it_had() -> None:
    part = qtab.train(LAKE, seed=0, episodes=20, epsilon_schedule="linear", min_epsilon=0.0, epsilon=1.0)
    whole = qtab.resume(part, 40)
    assert epsilons(whole)[:20].tolist() == epsilons(part).tolist()
    assert epsilons(whole)[20:].tolist() == epsilons(qtab.train(config=whole.config))[20:].tolist()


def test_values_that_no_goal_has_changed_are_not_called_noisy() -> None:
    run = qtab.train(LAKE, seed=0, episodes=200, epsilon=0.0, learning_rate=1.0)
    assert not run.episode_returns.any()
    assert qtab.diagnose(run, seeds=0).names == ("not solved", "exploration")


def test_few_updates_where_results_vary_are_no_reason_for_a_learning_rate_of_1() -> None:
    run = qtab.train("Blackjack-v1", seed=0, episodes=500, learning_rate=0.01)
    found = qtab.diagnose(run, seeds=0)["slow learning"]
    assert (found.advice, found.changes) == ("train longer, such as episodes=2500", ({"episodes": 2500},))


def test_what_if_names_what_cannot_be_made_again() -> None:
    env: Any = gym.make(LAKE)
    env.unwrapped.P[0][0] = [(1.0, 15, 1.0, True)]
    diagnosis = qtab.diagnose(qtab.train(env, seed=0, episodes=300))
    assert diagnosis.reasons["exploration"] == "its environment cannot be made again"
    expected = "what_if must make the environment of the run again: the environment FrozenLake-v1 cannot be made as"
    with pytest.raises(ValueError, match=expected):
        diagnosis.what_if(2)
