"""The book's experiments: their environments, their claims with fewer runs, and their training."""

import csv
from typing import Any

import matplotlib.colors
import numpy as np
import pytest

import qtab
from qtab.book import runner
from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.result import CSV_COLUMNS
from support.environments.shortest_path import shortest_path
from support.parity import run_of

NAMES = [name for name, experiment in qtab.book.EXPERIMENTS.items() if isinstance(experiment, TrainingExperiment)]


def training_experiment(name: str) -> TrainingExperiment:
    experiment = qtab.book.find(name)
    assert isinstance(experiment, TrainingExperiment)
    return experiment


def line(result, name):
    return next(line for line in result.lines if line.name == name)


def measured(number, name, alpha, runs, **changes):
    """(episodes,) The mean return of each episode of one setting."""
    experiment = training_experiment(number)
    setting: Any = next(one for one in experiment.settings if (one.line, one.x) == (name, (alpha,)))
    outcome = runner.train_runs(setting.env, {**experiment.config(setting), **changes}, range(runs), 2)
    return outcome.returns.mean(axis=0)


def test_the_shortest_path_through_the_windy_grid_world_takes_fifteen_steps():
    env = qtab.book.windy_grid_world()
    assert shortest_path(env) == 15
    assert {reward for row in env.P.values() for [(_, _, reward, _)] in row.values()} == {-1.0}
    up, right, down, left = range(4)
    assert env.P[33][right] == [(1.0, 24, -1.0, False)]  # the wind of the column that it leaves: one up
    assert env.P[56][left] == [(1.0, 35, -1.0, False)]  # two up
    assert env.P[6][up] == [(1.0, 6, -1.0, False)]
    assert env.P[47][down] == [(1.0, 37, -1.0, True)]  # blown back, into the goal


def test_the_shortest_path_through_the_maze_takes_fourteen_steps():
    env = qtab.book.dyna_maze()
    assert shortest_path(env) == 14
    up, right, _, left = range(4)
    assert env.P[19][right] == [(1.0, 19, 0.0, False)]  # an obstacle
    assert env.P[18][left] == [(1.0, 18, 0.0, False)]  # the edge
    assert env.P[17][up] == [(1.0, 8, 1.0, True)]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name == "figure-8.2")) for name in NAMES]
)
def test_an_experiment_equals_the_reference(name):
    experiment = training_experiment(name)
    lines = {setting.line: setting for setting in experiment.settings}
    for setting in {id(setting): setting for setting in (*list(lines.values())[:1], experiment.settings[-1])}.values():
        env = setting.env if isinstance(setting.env, str) else setting.env()
        config = {**experiment.config(setting), "episodes": 2, "max_episode_steps": 80}
        run = qtab.train(env, seed=2, **config)
        assert run.config.backend == "rust"
        assert qtab.verify(run, env=None if isinstance(env, str) else env).equal


@pytest.mark.parametrize("name", [name for name in NAMES if name not in ("figure-6.3", "figure-10.1")])
def test_an_experiment_makes_a_table_and_a_picture(name, tmp_path):
    result = qtab.book.run(name, runs=2, seed=5)
    text = str(result)
    assert "FEWER" in text
    assert "2 runs of each setting" in text
    for made in result.lines:
        assert made.name in text
        assert made.runs == 2
        assert np.isfinite(made.mean).all()
        assert np.isfinite(made.error).all()
    result.save(tmp_path / "points.csv")
    with (tmp_path / "points.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == CSV_COLUMNS
    assert len(rows) == sum(len(made.x) for made in result.lines)
    assert float(rows[0]["mean"]) == result.lines[0].mean[0]
    figure: Any = result.plot().figure
    repeated = 2 if name == "section-9.5.2" else 0  # tile coding is in each of its three panels
    assert sum(len(ax.lines) for ax in figure.axes) == sum(made.drawn for made in result.lines) + repeated


def test_the_cost_to_go_grows_towards_the_true_cost():
    result = qtab.book.run("10.1")
    largest = [made.mean[0] for made in result.lines]
    assert result.runs == result.lines[0].runs == 1
    assert np.isnan(result.lines[0].error).all()
    assert largest[0] < 50 < 90 < largest[-1] < 150
    assert len(result.plot().figure.axes) == 5
    with pytest.raises(ValueError, match="ax must be None"):
        result.plot(result.plot())


def test_threads_and_other_runs_do_not_change_a_run():
    several = qtab.book.run("8.2", runs=3, seed=7, threads=2)
    for threads in (1, 3):
        again = qtab.book.run("8.2", runs=3, seed=7, threads=threads)
        for one, other in zip(several.lines, again.lines, strict=True):
            assert one.mean.tobytes() == other.mean.tobytes()
    experiment = training_experiment("10.4")
    setting: Any = experiment.settings[3]
    alone = qtab.train(setting.env, seed=8, **experiment.config(setting))
    outcome = runner.train_runs(setting.env, experiment.config(setting), [7, 8], 2)
    assert outcome.lengths[1].tolist() == alone.episode_lengths.tolist()


def test_a_run_that_diverges_counts_as_truncated_where_train_raises():
    experiment = training_experiment("12.11")
    setting: Any = next(one for one in experiment.settings if (one.line, one.x) == ("accumulating", (1.6,)))
    config = experiment.config(setting)
    outcome = runner.train_runs(setting.env, config, range(6), 2)
    assert outcome.diverged.all()
    assert outcome.truncated[:, -1].all()
    assert (outcome.lengths[:, -1] == 5000).all()
    assert (outcome.returns == -outcome.lengths).all()
    with pytest.raises(OverflowError) as caught:
        qtab.train(setting.env, seed=0, **config)
    finished = run_of(caught.value).episode_lengths
    assert outcome.lengths[0, : len(finished)].tolist() == finished.tolist()
    assert outcome.truncated[0, len(finished) :].all()


def test_other_errors_are_raised():
    config: dict[str, Any] = {"discretizer": "tiles", "episodes": 1, "max_episode_steps": 5, "learning_rate": 3.0}
    with pytest.raises(ValueError, match="learning_rate"):
        runner.train_runs("MountainCar-v0", config, [0], 1)


def test_double_q_learning_goes_left_less_often():
    result = qtab.book.run("figure-6.5", runs=300)
    single, double = line(result, "Q-learning").mean, line(result, "Double Q-learning").mean
    assert single[:2].mean() == pytest.approx(50, abs=8)
    assert single[15:30].mean() > 80
    assert double[15:30].mean() < 50
    assert 5 < single[-50:].mean() < 20
    assert double[-50:].mean() < single[-50:].mean()


def test_planning_needs_fewer_episodes():
    result = qtab.book.run("8.2", runs=10)
    none, some, many = (line(result, f"n = {n}").mean for n in (0, 5, 50))
    assert many[1] < some[1] < none[1]
    assert many[2] < 30 < some[2] < none[2]
    assert all(mean[-10:].mean() < 22 for mean in (none, some, many))


def test_sarsa_learns_the_safe_path_along_the_cliff():
    result = qtab.book.run("6.6", runs=20)
    assert line(result, "Sarsa").mean[-200:].mean() > -32 > -40 > line(result, "Q-learning").mean[-200:].mean()


def test_expected_sarsa_wins_on_the_cliff_and_full_steps_ruin_sarsa():
    sarsa, q_learning, expected = (
        [measured("6.3", f"{name}, asymptotic", alpha, 2, episodes=4000)[1000:].mean() for alpha in (0.1, 0.5, 0.9)]
        for name in ("Sarsa", "Q-learning", "Expected Sarsa")
    )
    assert np.mean(expected) == pytest.approx(-20.7, abs=0.4)
    assert np.ptp(expected) < 1
    assert np.mean(q_learning) == pytest.approx(-50.8, abs=1.5)
    assert expected[0] > sarsa[0] > sarsa[1] > sarsa[2]
    assert sarsa[2] < -60
    interim = [measured("6.3", "Expected Sarsa, interim", alpha, 30).mean() for alpha in (0.2, 0.6, 1.0)]
    assert interim[0] < interim[1] < interim[2]


def test_an_intermediate_n_learns_fastest():
    best = {n: -measured("10.4", f"n = {n}", alpha, 40).mean() for n, alpha in ((1, 1.13), (4, 0.8), (16, 0.4))}
    assert best[4] < best[1]
    assert best[4] < best[16]


def test_without_traces_sarsa_lambda_is_one_step_sarsa():
    traces, steps = measured("12.10", "λ = 0", 0.4, 3), measured("10.4", "n = 1", 0.4, 3)
    assert traces.tobytes() == steps.tobytes()


@pytest.mark.slow
def test_true_online_learns_fastest_and_accumulating_traces_diverge():
    result = qtab.book.run("12.11", runs=10)
    true_online, clearing, replacing, accumulating = result.lines
    small = slice(0, 4)
    assert (true_online.mean[small] > replacing.mean[small]).all()
    assert (replacing.mean[small] > clearing.mean[small]).all()
    assert true_online.mean.max() > clearing.mean.max()
    assert (accumulating.diverged[5:] == 10).all()
    assert (clearing.mean[5:9] > -400).all()
    assert (accumulating.mean[5:9] < -4000).all()


def test_a_complete_figure_has_the_books_number_of_runs():
    counts = {name: qtab.book.EXPERIMENTS[name].runs for name in NAMES}
    assert counts["figure-6.3"] == 50_000
    assert counts["figure-6.5"] == 10_000
    assert counts["figure-8.2"] == 30
    assert {counts[f"figure-{number}"] for number in ("10.2", "10.3", "10.4", "12.10", "12.11")} == {100}
    limits = {name: training_experiment(name).max_episode_steps for name in NAMES}
    assert {name for name, limit in limits.items() if limit == 20_000} == {"figure-10.3", "figure-10.4"}
    assert {name: limits[f"figure-{name}"] for name in ("8.4", "8.5")} == {"8.4": 3_000, "8.5": 6_000}
    assert set(limits.values()) == {1_000, 3_000, 5_000, 6_000, 20_000}


def test_an_experiment_is_found_by_its_number():
    assert qtab.book.find("10.4") is qtab.book.find("Figure 10.4") is qtab.book.EXPERIMENTS["figure-10.4"]
    assert qtab.book.find("6.5") is qtab.book.EXPERIMENTS["figure-6.5"]  # not example-6.5, which comes first
    assert qtab.book.find("6.6") is qtab.book.EXPERIMENTS["example-6.6"]
    with pytest.raises(ValueError, match=r"one of .*example-6\.5, .*figure-12\.11, .*got '99'"):
        qtab.book.find("99")
    with pytest.raises(TypeError, match=r"got 10\.4"):
        qtab.book.find(10.4)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("settings", "error", "message"),
    [
        ({"runs": 0}, ValueError, "runs must be an integer of at least 1, got 0"),
        ({"runs": 1.5}, TypeError, "runs must be an integer of at least 1, got 1.5"),
        ({"runs": True}, TypeError, "runs must be"),
        ({"seed": -1}, ValueError, "seed must be an integer of at least 0, got -1"),
        ({"threads": 0}, ValueError, "threads must be an integer from 1 to 1024, got 0"),
        ({"progress": 1}, TypeError, "progress must be True, False or None, got 1"),
    ],
)
@pytest.mark.parametrize("name", ["8.2", "10.1"])
def test_bad_arguments_are_refused(name, settings, error, message):
    with pytest.raises(error, match=message):
        qtab.book.run(name, **settings)


def outcome(*lengths):
    steps = np.array(lengths)
    cut = np.zeros(steps.shape, bool)
    return runner.EpisodeLog(-steps.astype(float), steps, cut, cut[:, 0])


def test_measures_of_runs_are_computed_as_documented():
    from qtab.book import setting
    from qtab.book.figures.chapter_06 import example_6_5, figure_6_5

    several = outcome([2, 1, 1], [1, 2, 3])
    assert setting.mean_length(several).tolist() == [[4 / 3], [2.0]]
    assert setting.mean_return(several).tolist() == [[-4 / 3], [-2.0]]
    assert setting.episodes_by((1, 2, 3, 100))(several).tolist() == [[0, 1, 2, 3], [1, 1, 2, 3]]
    assert figure_6_5.left(several).tolist() == [[100.0, 0.0, 0.0], [0.0, 100.0, 0.0]]
    # Episodes end after 7,000, 7,001, 7,999 and 8,001 steps: the two in the middle count.
    assert example_6_5.last_lengths(outcome([7000, 1, 998, 2])).tolist() == [[499.5]]


def test_no_customer_is_accepted_without_a_free_server():
    ax: Any = qtab.book.run("figure-10.5", runs=1, progress=False).plot()
    policy = ax.figure.axes[0].collections[0]
    assert policy.get_coordinates()[..., 0].min() == 0.5  # the picture of the policy begins with one free server


def test_the_lines_of_a_figure_differ_in_color_and_agree_in_their_markers():
    ax: Any = qtab.book.run("figure-8.7", progress=False).plot()
    colors = np.array([matplotlib.colors.to_rgb(line.get_color()) for line in ax.lines])
    apart = np.linalg.norm(colors[:, None] - colors, axis=-1)[~np.eye(len(colors), dtype=bool)]
    assert apart.min() > 0.2
    assert len({line.get_marker() for line in ax.lines}) == 1


def test_the_final_values_of_the_gambler_do_not_hide_the_last_sweep():
    ax: Any = qtab.book.run("figure-4.3", progress=False).plot()
    widths = {line.get_label(): (line.get_zorder(), line.get_linewidth()) for line in ax.figure.axes[0].lines}
    (below, broad), (above, narrow) = widths["final values"], widths["sweep 32"]
    assert below < above
    assert broad > 2 * narrow
