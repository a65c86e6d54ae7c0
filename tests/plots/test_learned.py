"""Pictures of what was learned show the numbers of the run."""

import sys
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure

import qtab
from qtab import plots
from qtab.envs import grid_worlds
from qtab.envs.registry import ENTRIES, EXTRA
from qtab.plots.parts.colors import brightness, is_dark

PICTURES: tuple[Any, ...] = (plots.values, plots.policy, plots.visits, plots.trajectory)
SHORT: dict[str, Any] = {"episodes": 5, "seed": 0, "visits": True, "max_episode_steps": 40}
CAR = "MountainCar-v0"


@pytest.fixture(scope="module")
def car() -> qtab.Run:
    return qtab.train(CAR, episodes=200, seed=0, visits=True)


@pytest.fixture(scope="module")
def lake() -> qtab.Run:
    return qtab.train("FrozenLake-v1", episodes=2000, seed=0, visits=True)


def shown(ax: Any) -> Any:
    """The numbers of the colored cells, the last of what is drawn in colors; NaN where nothing is."""
    mesh = [collection for collection in ax.collections if type(collection).__name__ == "QuadMesh"][-1]
    return np.ma.filled(mesh.get_array().astype(float), np.nan)


TWINS = ("CartPole-v0", "FrozenLake8x8-v1", "CliffWalkingSlippery-v1")
"""Drawn as environments of the same names."""
SMALLER: dict[str, dict[str, Any]] = {"qtab/JacksCarRental-v0": {"cars": 4}}
"""Of all its cars, the rental has millions of transitions."""


@pytest.mark.parametrize("env", [env for env in [*ENTRIES, *EXTRA] if env not in TWINS])
def test_every_environment_can_be_drawn(env: str) -> None:
    run = qtab.train(env, env_kwargs=SMALLER.get(env, {}), **SHORT)
    for picture in PICTURES:
        ax = Figure().subplots()
        assert picture(run, ax) is ax
        assert ax.get_title("left")
        assert ax.get_xlabel()


@pytest.mark.parametrize("picture", [plots.values, plots.policy])
def test_dark_styles_have_light_letters_and_dark_cells_where_nothing_is_known(picture: Any) -> None:
    unknown = qtab.train("FrozenLake-v1", episodes=1, seed=0, visits=True)
    for style, dark in (("default", False), ("dark_background", True)):
        with plt.style.context(style):
            ax = picture(unknown)
            [start] = [text for text in ax.texts if text.get_text() == "S"]
            assert (brightness(start.get_color()) > 0.5) is dark
            grey = next(mesh for mesh in ax.collections if type(mesh).__name__ == "QuadMesh").get_cmap()(0.0)
            assert (brightness(grey) < 0.5) is dark


def test_the_background_decides_what_is_dark_and_the_text_where_it_is_transparent() -> None:
    for face, text, dark in (("#202020", "black", True), ("white", "white", False), ("none", "white", True)):
        with plt.rc_context({"text.color": text}):
            ax = Figure(facecolor=face).subplots()
            ax.set_facecolor("none")
            assert is_dark(ax) is dark, face


def test_values_are_those_of_the_table_and_grey_where_it_was_never_updated(car: qtab.Run) -> None:
    assert car.visits is not None
    visited = car.visits.any(axis=-1)
    expected = np.where(visited, car.q_table.max(axis=-1), np.nan)
    ax = plots.values(car)
    np.testing.assert_array_equal(shown(ax), expected.T)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("position (m)", "velocity (m/step)")
    assert ax.get_xlim() == (car.axes[0].edges[0], car.axes[0].edges[-1])


def test_tile_coding_is_sampled() -> None:
    run = qtab.train(CAR, preset="solved", episodes=30, seed=0)
    grid = shown(plots.values(run))
    assert grid.shape == (200, 200)
    position, velocity = (np.linspace(axis.edges[0], axis.edges[-1], 201) for axis in run.axes)
    known = np.argwhere(np.isfinite(grid))
    for y, x in known[:: len(known) // 50]:
        middle = np.array([position[x : x + 2].sum(), velocity[y : y + 2].sum()]) / 2
        assert grid[y, x] == run.values(middle.astype(np.float32))


def test_the_policy_is_that_of_the_run(car: qtab.Run) -> None:
    assert car.visits is not None
    expected = np.where(car.visits.any(axis=-1), car.policy, np.nan)
    ax = plots.policy(car)
    np.testing.assert_array_equal(shown(ax), expected.T)
    legend: Any = ax.get_legend()
    assert [text.get_text() for text in legend.get_texts()] == ["push left", "no push", "push right"]


def test_visits_are_those_of_the_run(car: qtab.Run) -> None:
    assert car.visits is not None
    counts = car.visits.sum(axis=-1).astype(float)
    np.testing.assert_array_equal(shown(plots.visits(car)), np.where(counts > 0, counts, np.nan).T)


def test_arrows_point_where_the_actions_lead(lake: qtab.Run) -> None:
    directions = {0: (-1, 0), 1: (0, 1), 2: (1, 0), 3: (0, -1)}
    found = {}
    for quiver in plots.policy(lake).collections:
        if type(quiver).__name__ == "Quiver":
            arrows: Any = quiver
            for (x, y), u, v in zip(arrows.get_offsets(), arrows.U, arrows.V, strict=True):
                move = np.sign(np.round([u, v], 6)).astype(int)
                cell = np.floor(np.array([x, y]) + 0.32 * move).astype(int)
                found[4 * cell[1] + cell[0]] = tuple(move.tolist())
    holes_and_goal = (5, 7, 11, 12, 15)
    assert found == {state: directions[lake.policy[state]] for state in range(16) if state not in holes_and_goal}


def test_an_optimum_costs_nothing_and_every_other_action_what_it_gives_away(lake: qtab.Run) -> None:
    best = qtab.optimum("FrozenLake-v1")
    optimal = qtab.train("FrozenLake-v1", episodes=1, seed=0, learning_rate=0.0, initial_q=best.q_values)
    assert not np.isfinite(shown(plots.difference(optimal, best))).any()
    worst = qtab.train("FrozenLake-v1", episodes=1, seed=0, learning_rate=0.0, initial_q=-best.q_values)
    cost = best.values - best.q_values.min(axis=-1)
    grid = shown(plots.difference(worst, best)).ravel()
    costly = [state for state in range(16) if state not in (5, 7, 11, 12, 15) and cost[state] > 1e-9]
    np.testing.assert_allclose(grid[costly], cost[costly])
    assert np.isfinite(grid).sum() == len(costly) > 0


def test_several_runs_have_one_scale(car: qtab.Run) -> None:
    other = qtab.train(CAR, preset="solved", episodes=50, seed=0, discount=car.config.discount)
    figure: Any = plots.values([car, other]).figure
    ranges = {
        mesh.get_clim()
        for ax in figure.axes[:2]
        for mesh in ax.collections
        if type(mesh).__name__ == "QuadMesh" and mesh.get_cmap().name == "viridis"
    }
    assert len(ranges) == 1
    with pytest.raises(ValueError, match="ax must be None for 2 runs"):
        plots.values([car, other], Figure().subplots())
    with pytest.raises(ValueError, match="run must hold runs of one environment, got 'CartPole-v1', 'MountainCar-v0'"):
        plots.values([car, qtab.train("CartPole-v1", episodes=1)])


def test_many_seeds_show_their_mean_and_their_most_frequent_action() -> None:
    runs = qtab.train_many("CliffWalking-v1", 5, episodes=300, tables=True)
    mean = np.mean([run.q_table.max(axis=-1) for run in runs], axis=0).reshape(4, 12)
    grid = shown(plots.values(runs))
    np.testing.assert_allclose(grid[:3], mean[:3], rtol=1e-12)
    assert np.isnan(grid[3, 1:]).all()
    plots.policy(runs)
    plots.difference(runs, qtab.optimum(runs))
    with pytest.raises(ValueError, match="run must hold tables: train_many"):
        plots.values(qtab.train_many("CliffWalking-v1", 2, episodes=2))


def test_a_slice_is_the_table_at_the_cells_that_were_named() -> None:
    run = qtab.train("CartPole-v1", episodes=300, seed=0, visits=True)
    assert run.visits is not None
    table = np.where(run.visits.any(axis=-1), run.q_table.max(axis=-1), np.nan)
    column = int(np.searchsorted(run.axes[0].edges[1:-1], 0.5, side="right"))
    row = int(np.searchsorted(run.axes[3].edges[1:-1], -0.2, side="right"))
    ax = plots.values(run, at={"cart position": 0.5, "pole angular velocity": -0.2})
    np.testing.assert_array_equal(shown(ax), table[column, :, :, row].T)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("cart velocity (m/s)", "pole angle (rad)")


@pytest.mark.parametrize(
    ("env", "at", "error", "message"),
    [
        ("CartPole-v1", {"pole angel": 0}, ValueError, r"got 'pole angel' \(did you mean 'pole angle'\?\)"),
        ("CartPole-v1", {"cart position": 9}, ValueError, r"at\['cart position'\] must lie in \[-2.4, 2.4\], got 9"),
        ("CartPole-v1", 3, TypeError, "at must be a mapping of the names of components to numbers, got 3"),
        (CAR, {"position": 0.0}, ValueError, "at must leave two components as the axes of the picture"),
        ("Taxi-v4", {"state": 0}, ValueError, "at must be None for Taxi-v4, whose picture shows every state"),
        ("Blackjack-v1", {"usable ace": 0}, ValueError, "at must be None for Blackjack-v1"),
    ],
)
def test_a_wrong_slice_is_named(env: str, at: Any, error: type[Exception], message: str) -> None:
    run = qtab.train(env, **SHORT)
    with pytest.raises(error, match=message):
        plots.values(run, at=at)


@pytest.mark.parametrize(
    ("layout", "error", "message"),
    [
        ((7, 9), ValueError, "layout must have 70 cells in rows of one length, one for each state"),
        ("S..G", TypeError, "layout must be rows of text, or the numbers of rows and columns, got 'S..G'"),
        (7, TypeError, "layout must be rows of text"),
    ],
)
def test_a_table_is_drawn_on_the_map_that_is_given(layout: Any, error: type[Exception], message: str) -> None:
    run = qtab.train(grid_worlds.windy_grid_world(), **{**SHORT, "episodes": 20, "max_episode_steps": 500})
    ax = plots.policy(run, layout=grid_worlds.WINDY_GRID_WORLD, action_names=grid_worlds.ACTION_NAMES)
    assert {"S", "G"} <= {text.get_text() for text in ax.texts}
    env = grid_worlds.windy_grid_world()
    assert plots.trajectory(run, env=env, layout=(7, 10), episodes=1).get_title("left").startswith("TabularEnv")
    with pytest.raises(error, match=message):
        plots.values(run, layout=layout)
    with pytest.raises(ValueError, match="env must be given: 'TabularEnv'"):
        plots.trajectory(run, layout=(7, 10))
    with pytest.raises(ValueError, match="action_names must hold 4 names, got 1"):
        plots.policy(run, layout=(7, 10), action_names=["up"])


def test_a_path_leads_through_the_observations(car: qtab.Run) -> None:
    import gymnasium as gym

    env = gym.make(CAR)
    observation, _ = env.reset(seed=3)
    observations, over = [observation], False
    while not over:
        observation, _, terminated, truncated, _ = env.step(car.predict(observation)[0])
        observations.append(observation)
        over = terminated or truncated
    path: Any = max(plots.trajectory(car, episodes=1, seed=3).lines, key=lambda line: np.size(line.get_xdata()))
    np.testing.assert_allclose(np.stack(path.get_data(), axis=-1), observations, rtol=1e-6)


def test_a_picture_of_visits_needs_visits() -> None:
    run = qtab.train(CAR, episodes=1, seed=0)
    with pytest.raises(ValueError, match=r"run must have visits: qtab.train\(..., visits=True\) counts them"):
        plots.visits(run)
    with pytest.raises(TypeError, match="run must be a Run, whose visits can be counted"):
        plots.visits(qtab.optimum("FrozenLake-v1"))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [(3, "run must be a Run, Runs or an Optimum, got 3"), ("run.npz", r"got 'run\.npz'; qtab\.load reads one")],
)
def test_what_cannot_be_drawn_is_refused(car: qtab.Run, wrong: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        plots.values(wrong)
    with pytest.raises(ValueError, match="run must hold at least one run, got an empty list"):
        plots.policy([])
    run = qtab.train(CAR, episodes=1, seed=0)
    with pytest.raises(ValueError, match="optimum must be that of 'MountainCar-v0', the run's environment"):
        plots.difference(run, qtab.optimum("FrozenLake-v1"))
    for draw in (*PICTURES, plots.schedule):
        with pytest.raises(TypeError, match="title must be a str, got 3"):
            draw(car, title=3)
    with pytest.raises(TypeError, match="numbers must be True or False, got 'no'"):
        plots.values(car, numbers="no")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "chosen",
    [
        {},
        {"epsilon_schedule": "exponential", "epsilon_decay": 0.9, "epsilon_warm_up": 3, "min_epsilon": 0.01},
        {"learning_rate_schedule": "linear", "learning_rate_warm_up": 2},
        {"learning_rate_schedule": "visits"},
        {"exploration": "softmax", "temperature": 2.0},
    ],
)
def test_the_schedule_is_that_of_the_reference(chosen: dict[str, Any]) -> None:
    from qtab.config.schedules import EpsilonGreedy
    from qtab.config.schedules import policy as policy_of
    from qtab.reference.parts.schedules import epsilon_schedule
    from qtab.results.rates import rates_of

    run = qtab.train(CAR, episodes=30, seed=0, **chosen)
    ax = plots.schedule(run)
    assert ax.get_legend() is not None
    behaviour = policy_of(run.config)
    if isinstance(behaviour, EpsilonGreedy):
        reference, expected = epsilon_schedule(run.config), []
        for _ in range(30):
            expected.append(reference.value)
            reference.end_episode()
        np.testing.assert_allclose(rates_of(run, behaviour.epsilon, np.arange(30)), expected, atol=1e-12)


def test_the_overview_has_four_panels(car: qtab.Run) -> None:
    titles = [ax.get_title("left") for ax in plots.overview(car).axes[:4]]
    assert titles == [CAR, "Values", "Greedy policy", "Visits"]
    plain = qtab.train(CAR, episodes=20, seed=0)
    assert plots.overview(plain).axes[3].get_title("left") == "Schedule"


@pytest.mark.parametrize("picture", [*PICTURES, plots.schedule, plots.overview])
def test_without_matplotlib_the_message_says_what_to_install(
    picture: Any, lake: qtab.Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == "matplotlib"]:
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install"):
        picture(lake)
