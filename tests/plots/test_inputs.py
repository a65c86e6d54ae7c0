"""What plots take, and what they refuse by name and value."""

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure

import qtab
from qtab import plots
from qtab.plots.parts.axes import not_shown

RETURNS = np.cumsum(np.random.default_rng(0).normal(1, 5, size=(12, 300)), axis=1)
RUN = qtab.train("MountainCar-v0", seed=0, episodes=50)
RUNS = qtab.train_many("MountainCar-v0", 5, episodes=50)
GRID: dict[str, Any] = {"learning_rate": [0.1, 0.2, 0.4], "discount": [0.9, 1.0]}
SWEEP = qtab.sweep("MountainCar-v0", GRID, seeds=3, episodes=50, block=10)


def labels(ax: Any) -> list[str]:
    return [text.get_text().replace("\n", " ") for text in ax.get_legend().get_texts()]


@pytest.mark.parametrize("draw", [plots.learning_curves, plots.distribution, plots.profile])
def test_plots_take_runs_sweeps_arrays_and_all_of_them_by_name(draw: Any) -> None:
    array = RETURNS if draw is plots.learning_curves else RETURNS[:, 0]
    six = [f"learning_rate = {rate:g}, discount = {discount:g}" for rate in (0.1, 0.2, 0.4) for discount in (0.9, 1)]
    for data in (RUN, RUNS, array, array.tolist()):
        assert len(labels(draw(data))) == 1
    assert [label.partition(":")[0] for label in labels(draw(SWEEP))] == six
    names = labels(draw({"one": RUN, "many": RUNS, "array": array, "sweep": SWEEP}))
    assert [name.partition(":")[0] for name in names] == ["one", "many", "array"] + ["sweep"] * 6
    assert len(labels(draw({"a": SWEEP, "b": SWEEP}, settings=[0, 3]))) == 4


def test_the_curves_of_a_sweep_are_those_of_its_runs() -> None:
    runs = qtab.train_many("MountainCar-v0", 3, episodes=50, learning_rate=0.4, discount=1.0)
    ours, theirs = plots.learning_curves(SWEEP, settings=[5]), plots.learning_curves(runs, block=10)
    for ax in (ours, theirs):
        assert len(ax.lines) == 3 + 1
    assert ours.lines[-1].get_xydata().tolist() == theirs.lines[-1].get_xydata().tolist()  # type: ignore[union-attr]


def test_the_final_return_of_a_run_is_that_of_its_last_hundred_episodes() -> None:
    run = qtab.train("MountainCar-v0", seed=0, episodes=250, epsilon=0.0)
    assert f"median {run.episode_returns[-100:].mean():.4g}" in labels(plots.distribution(run))[0]
    assert f"{run.episode_returns[-100:].mean():.4g}" != f"{run.episode_returns[100:200].mean():.4g}"


def test_of_many_settings_the_best_are_drawn_and_the_legend_reports_it() -> None:
    rates = np.linspace(0.1, 1, 11).tolist()
    sweep = qtab.sweep("CliffWalking-v1", {"learning_rate": rates}, seeds=2, episodes=30, max_episode_steps=200)
    means = [sweep.values("final_return", setting).mean() for setting in range(11)]
    ax = plots.distribution(sweep)
    assert ax.get_legend().get_title().get_text().startswith("the best 8 of 11 settings by mean final return")  # type: ignore[union-attr]
    best = {f"learning_rate = {rates[setting]:.4g}" for setting in np.argsort(means)[-8:]}
    assert {label.partition(":")[0] for label in labels(ax)} == best


@pytest.mark.parametrize(
    ("episodes", "block", "points"), [(3, 1, 3), (8, 1, 8), (99, 2, 49), (150, 5, 30), (500, 20, 25), (2000, 100, 20)]
)
def test_short_runs_have_a_mean_line_whose_label_tells_the_block(episodes: int, block: int, points: int) -> None:
    run = qtab.train("MountainCar-v0", episodes=episodes, seed=0)
    plural = "" if block == 1 else "s"
    [line] = [line for line in qtab.plot(run).lines if line.get_label() == f"mean of {block} episode{plural}"]
    assert len(line.get_xdata()) == points  # type: ignore[arg-type]
    ax = plots.learning_curves(run)
    assert ax.get_ylabel() == f"return, mean of {block} episode{plural}"
    assert len(ax.collections) == 0  # a single run has no interval
    assert labels(ax) == ["1 run"]


def test_a_known_threshold_is_marked_where_it_is_near_the_returns() -> None:
    solved = qtab.train("MountainCar-v0", preset="solved", episodes=300, seed=0)
    assert "threshold -110" in labels(qtab.plot(solved))
    assert "threshold -110" in labels(plots.learning_curves({"solved": solved}))
    assert "threshold -110" not in labels(qtab.plot(solved, threshold=False))
    assert "threshold -110" not in labels(qtab.plot(RUN))  # all its returns are -200
    assert "threshold -150" in labels(plots.distribution(RUNS, threshold=-150))
    assert "threshold 0" in labels(plots.learning_curves(RETURNS, threshold=0))


ALL: list[Any] = [qtab.plot, plots.learning_curves, plots.distribution, plots.profile]
MANY = ALL[1:]
ARRAY = RETURNS[:, :8]
NAN = np.where(ARRAY[0, 0] < ARRAY, np.nan, ARRAY)


@pytest.mark.parametrize(
    ("draw", "data", "options", "error", "message"),
    [
        *((draw, RUN, {"ax": 3}, TypeError, "ax must be a matplotlib Axes or None, got int, 3") for draw in ALL),
        (qtab.plot, RUN, {"ax": Figure().subplots(2)}, TypeError, r"ax must be .* shape \(2,\): pass one of its axes"),
        *((draw, 3, {}, TypeError, "(run|returns|scores) must be a Run.* got 3$") for draw in ALL),
        *((draw, "a.npz", {}, TypeError, "must be a Run.* got 'a.npz'") for draw in ALL),
        *((draw, {}, {}, ValueError, "(returns|scores) must name at least one setting, got {}") for draw in MANY),
        *((draw, [], {}, ValueError, "(returns|scores) must (have|hold) .* got") for draw in MANY),
        *((draw, {"a": "b"}, {}, TypeError, r"(returns|scores)\['a'\] must be a Run.* got 'b'") for draw in MANY),
        *((draw, {"a": [1.0, "b"]}, {}, TypeError, r"\['a'\] must hold numbers") for draw in MANY),
        *((draw, {"a": NAN[0]}, {}, ValueError, r"\['a'\] must be finite, got \d of 8 NaN or inf") for draw in MANY),
        (plots.distribution, ARRAY, {}, ValueError, "returns must be one-dimensional"),
        (plots.learning_curves, ARRAY[None], {}, ValueError, r"returns must have the shape \(runs, episodes\)"),
        (plots.profile, {"a": {}}, {}, ValueError, r"scores\['a'\] must hold at least one environment"),
        (plots.profile, {"a": {"x": NAN[0]}}, {}, ValueError, r"scores\['a'\]\['x'\] must be finite"),
        *((draw, RUNS, {"settings": [0]}, ValueError, "settings must be None where") for draw in MANY),
        *(
            (draw, SWEEP, {"settings": [6]}, ValueError, "settings must be an integer from 0 to 5, got 6")
            for draw in MANY
        ),
        *((draw, SWEEP, {"settings": 2}, TypeError, "settings must be a list of indices") for draw in MANY),
        *((draw, SWEEP, {"colors": "blu"}, ValueError, "colors must be a color.* got 'blu'") for draw in MANY),
        *((draw, SWEEP, {"colors": ["red"]}, ValueError, "colors must hold at least 6 colors, got 1") for draw in MANY),
        *((draw, {"a": RUNS}, {"colors": {"b": "red"}}, ValueError, "got none for 'a'") for draw in MANY),
        *((draw, {"a": RUNS}, {"colors": 3}, TypeError, "colors must be a color.* got 3") for draw in MANY),
        (qtab.plot, RUN, {"color": "blu"}, ValueError, "colors? must be a color"),
        (qtab.plot, RUNS, {}, TypeError, "run must be a Run, got <Runs .*; qtab.plots.learning_curves draws many"),
        (qtab.plot, RUN, {"optimum": np.nan}, ValueError, "optimum must be finite, got nan"),
        (qtab.plot, RUN, {"optimum": True}, TypeError, "optimum must be a number or a result"),
        (qtab.plot, RUN, {"threshold": np.inf}, ValueError, "threshold must be finite, got inf"),
        (qtab.plot, RUN, {"block": 10**30}, ValueError, "block must be an integer from 1 to 50, got 1000000"),
        (
            plots.learning_curves,
            {"a": [0.0], "b": SWEEP},
            {},
            ValueError,
            "returns must have at least 10 episodes, the block of the sweep that is drawn with them, got 1",
        ),
        (plots.learning_curves, SWEEP, {"block": 15}, ValueError, "block must be a multiple of the sweep's block, 10"),
        (
            plots.learning_curves,
            [1.0, 2.0, 3.0],
            {"block": 4},
            ValueError,
            "block must be an integer from 1 to 3, got 4",
        ),
        (plots.learning_curves, RUNS, {"statistic": "men"}, ValueError, r"statistic must .* \(did you mean 'mean'\?\)"),
        (plots.learning_curves, {"a": RUNS}, {"label": "b"}, ValueError, "label must be None where returns has names"),
        (plots.learning_curves, RUNS, {"index": -1}, ValueError, "index must be an integer of at least 0"),
        (plots.distribution, RUNS, {"bins": 10**8}, ValueError, "bins must be an integer from 1 to 1000"),
        *((draw, RUNS, {"title": 3}, TypeError, "title must be a str, got 3") for draw in MANY),
        (plots.learning_curves, RUN, {"label": 3}, TypeError, "label must be a str, got 3"),
        (plots.learning_curves, RUN, {"confidence": "x"}, TypeError, "confidence must be a number"),
        (plots.profile, RUN, {"confidence": 95}, ValueError, "confidence must lie in"),
        (plots.distribution, RUNS, {"bins": 0}, ValueError, "bins must be an integer from 1 to 1000"),
        (plots.profile, RUNS, {"thresholds": [np.nan]}, ValueError, "thresholds must be finite"),
    ],
)
def test_bad_input_is_refused_by_name(draw: Any, data: Any, options: Any, error: Any, message: str) -> None:
    with pytest.raises(error, match=message):
        draw(data, **options)


numbers = st.one_of(st.floats(), st.floats(-1e3, 1e3), st.integers(), st.none(), st.booleans(), st.complex_numbers())
names = st.text("ab /_", max_size=3)
OBJECTS: dict[str, Any] = {"run": RUN, "runs": RUNS, "sweep": SWEEP, "2d": RETURNS[:2, :3], "1d": RETURNS[0, :3]}
leaves = st.one_of(numbers, names, st.sampled_from(sorted(OBJECTS)))
anything = st.recursive(
    leaves,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(names | st.floats(), inner, max_size=3),
    max_leaves=8,
)


def with_objects(data: Any) -> Any:
    """The data with objects in place of their names, whose representations are short."""
    if isinstance(data, dict):
        return {key: with_objects(value) for key, value in data.items()}
    if isinstance(data, list):
        return [with_objects(value) for value in data]
    return OBJECTS.get(data, data) if isinstance(data, str) else data


@pytest.mark.parametrize("draw", MANY)
@settings(max_examples=settings.default.max_examples // 3)  # type: ignore[union-attr]
@given(data=anything)
def test_anything_is_drawn_or_refused_in_one_line(draw: Any, data: Any) -> None:
    message = "returns must be drawn"
    with not_shown():
        try:
            draw(with_objects(data)).figure.canvas.draw()
        except (TypeError, ValueError) as error:
            message = str(error)
    assert re.match(r"(returns|scores)[^\n]* must ", message)
    assert len(message) < 250


def test_runs_without_an_episode_and_sweeps_without_a_run_are_refused() -> None:
    from dataclasses import replace

    empty = replace(RUNS, episode_returns=np.empty((0, 50)))
    failed = replace(SWEEP, columns={**SWEEP.columns, "error": np.array(["out of luck"] * len(SWEEP), dtype=object)})
    for draw in MANY:
        with pytest.raises(ValueError, match=r"\['a'\] must have at least one finished episode"):
            draw({"a": empty})
        with pytest.raises(ValueError, match="must have at least one run that succeeded"):
            draw(failed)
    with pytest.raises(ValueError, match="sweep must have at least one run that succeeded"):
        plots.sensitivity(failed, "discount")
