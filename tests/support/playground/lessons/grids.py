"""What the page says of CliffWalking and the grid worlds."""

import numpy as np

import qtab
from support.playground.lessons import SEEDS, Claims, Lesson, Lessons, last


def edge(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    assert {episode.total for episode in lesson.greedy_of_all(runs)} == {-13.0}
    assert 0.2 < (runs.episode_returns[:, -100:] <= -100).mean() < 0.3


def away_from_the_edge(lesson: Lesson, others: Lessons) -> None:
    runs, of_q_learning = lesson.runs(), others["CliffWalking-v1", "Q-learning on the edge"].runs()
    assert min(episode.steps for episode in lesson.greedy_of_all(runs)) > 13
    falls, more_falls = ((one.episode_returns[:, -100:] <= -100).mean(axis=1) for one in (runs, of_q_learning))
    assert (falls < more_falls).all()
    assert (round(last(runs).mean()), round(last(of_q_learning).mean())) == (-26, -47)
    assert (last(runs) > last(of_q_learning)).all()
    ends = [each.episode_returns[0, -25:].mean() for each in (runs, of_q_learning)]
    assert ends[0] < ends[1], "a few episodes of a single seed show the opposite"


def solved_cliff(lesson: Lesson, _: Lessons) -> None:
    assert {episode.steps for episode in lesson.greedy_of_all(lesson.runs())} == {13}
    assert (lesson.settings["learning_rate"], lesson.settings["epsilon"]) == (1, 0)


def falling_epsilon(lesson: Lesson, _: Lessons) -> None:
    returns = lesson.runs().episode_returns
    falls = returns <= -100
    assert (3 * falls[:, -100:].sum(axis=1) < falls[:, :100].sum(axis=1) + 1).all()
    assert (np.median(returns[:, -25:], axis=1) == -13).all()


def windy_sarsa(lesson: Lesson, _: Lessons) -> None:
    for episode in lesson.greedy_of_all(lesson.runs()):
        cells = [divmod(int(state), 10) for state in episode.states]
        assert episode.terminated
        assert 0 in [row for row, _ in cells]
        down = [row for row, column in cells if column == 9]
        assert down[-1] > down[0]


def windy_q_learning(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    for seed, episode in enumerate(lesson.greedy_of_all(runs)):
        assert episode.steps == 15
        values = [runs[seed].q_table[state].max() for state in episode.states[:-1]]
        np.testing.assert_allclose(values, np.arange(-15, 0), atol=1e-6)


def windy_softmax(lesson: Lesson, others: Lessons) -> None:
    runs = lesson.runs()
    assert {episode.steps for episode in lesson.greedy_of_all(runs)} == {15}
    assert (last(runs) < 10 * last(others["WindyGridWorld", "Q-learning"].runs())).all()


def open_field(lesson: Lesson, _: Lessons) -> None:
    barrier = ["....#...", "....#...", ".S..#.G.", "....#...", "........", "........"]
    assert lesson.grid is not None
    walled = Lesson(lesson.environment, lesson.settings, {**lesson.grid, "layout": barrier})
    assert all(episode.terminated for episode in walled.greedy_of_all(walled.runs()))


def maze(lesson: Lesson, others: Lessons) -> None:
    for episodes, most in ((5, 7), (10, 13)):
        assert max(_valued(lesson.runs(episodes=episodes))) < most
    planned = others["grid", "Maze, Dyna-Q"].runs()
    assert (lesson.runs().episode_lengths.sum(axis=1) > planned.episode_lengths.sum(axis=1)).all()


def planned_maze(lesson: Lesson, others: Lessons) -> None:
    runs = lesson.runs(episodes=5)
    states = "".join(lesson.grid["layout"] if lesson.grid else ()).count(".") + 1
    assert min(_valued(runs)) > states / 2
    assert (lesson.runs().episode_lengths[:, -5:].mean(axis=1) < 20).all()
    without = others["grid", "Maze, Q-learning"]
    assert {name: value for name, value in lesson.settings.items() if without.settings.get(name) != value} == {
        "algorithm": "dyna_q",
        "planning_steps": 50,
    }


def _valued(runs: qtab.Runs) -> list[int]:
    """Returns of each seed how many states have a value."""
    return [int((runs[seed].q_table.max(axis=-1) > 0).sum()) for seed in range(SEEDS)]


def four_rooms(lesson: Lesson, _: Lessons) -> None:
    assert lesson.grid is not None
    door = {"through the top": (2, 5), "through the left": (5, 1)}
    episode = lesson.greedy(lesson.train(0), 0)
    cells = [divmod(int(state), 11) for state in episode.states]
    used = next(cell for cell in door.values() if cell in cells)
    other = next(cell for cell in door.values() if cell != used)
    layout = list(lesson.grid["layout"])
    layout[used[0]] = layout[used[0]][: used[1]] + "#" + layout[used[0]][used[1] + 1 :]
    for change in ({"layout": layout}, {"rewards": [[*used, -10]]}):
        changed = Lesson(lesson.environment, lesson.settings, {**lesson.grid, **change})
        for seen in changed.greedy_of_all(changed.runs()):
            assert seen.terminated
            assert other in [divmod(int(state), 11) for state in seen.states]


CLAIMS: Claims = {
    ("CliffWalking-v1", "Q-learning on the edge"): edge,
    ("CliffWalking-v1", "Sarsa keeps away"): away_from_the_edge,
    ("CliffWalking-v1", "Solved"): solved_cliff,
    ("CliffWalking-v1", "ε falls to 0"): falling_epsilon,
    ("WindyGridWorld", "Sarsa"): windy_sarsa,
    ("WindyGridWorld", "Q-learning"): windy_q_learning,
    ("WindyGridWorld", "Too random: slow"): windy_softmax,
    ("grid", "Open field"): open_field,
    ("grid", "Maze, Q-learning"): maze,
    ("grid", "Maze, Dyna-Q"): planned_maze,
    ("grid", "Four rooms"): four_rooms,
}
