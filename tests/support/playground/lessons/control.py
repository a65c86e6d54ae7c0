"""What the page says of MountainCar, CartPole and Acrobot."""

import numpy as np
import pytest

from support.playground.lessons import Claims, Lesson, Lessons, last


def article(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    first_half = runs.episode_lengths[:, : lesson.settings["episodes"] // 2]
    assert ((first_half == 200).mean(axis=1) > 0.99).all()
    assert (last(runs) < -155).all()


def optimistic_car(lesson: Lesson, others: Lessons) -> None:
    runs = lesson.runs()
    first_flag = (runs.episode_returns > -200).argmax(axis=1)
    assert ((first_flag > 200) & (first_flag < 500)).all()
    assert (last(runs) > last(others["MountainCar-v0", "The article: fails"].runs()) + 15).all()
    assert (last(runs) < -110).all()


def solved_car(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    sums = np.cumsum(runs.episode_returns, axis=1)
    means = (sums[:, 100:] - sums[:, :-100]) / 100
    assert ((means >= -110).argmax(axis=1) < 300).all()
    assert (last(runs) >= -110).all()
    assert all(episode.terminated for episode in lesson.greedy_of_all(runs))


def weights(lesson: Lesson) -> int:
    return lesson.train(0, episodes=1).tables.size


def fourier_car(lesson: Lesson, others: Lessons) -> None:
    assert weights(lesson) == 108
    assert weights(others["MountainCar-v0", "Solved: tile coding"]) == 7776
    lengths = lesson.runs().episode_lengths
    assert lengths[:, :100].mean() == pytest.approx(160, abs=5)
    assert lengths[:, -100:].mean() == pytest.approx(130, abs=5)


def coarse_pole(lesson: Lesson, _: Lessons) -> None:
    assert (last(lesson.runs()) < 50).all()


def pole_in_bins(lesson: Lesson, _: Lessons) -> None:
    table = lesson.train(0).q_table
    pushes = table[table.shape[0] // 2, table.shape[1] // 2].argmax(axis=-1)
    assert (pushes[0] == 0).mean() > 0.7, "leaning to the left, it pushes left"
    assert (pushes[-1] == 1).mean() > 0.6
    assert lesson.greedy(lesson.train(0), 0).steps == 500


def solved_pole(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs(seeds=2, episodes=1000)
    assert (last(runs) > 495).all()
    assert all(episode.total == 500 for episode in lesson.greedy_of_all(runs))


def fourier_pole(lesson: Lesson, _: Lessons) -> None:
    assert weights(lesson) == 81 * 2
    returns = lesson.runs().episode_returns
    assert returns[:, :100].mean() == pytest.approx(275, abs=10)
    assert (returns[:, 200:] == 500).all()


def uncoupled_pole(lesson: Lesson, others: Lessons) -> None:
    assert weights(lesson) == 9 * 2
    coupled = others["CartPole-v1", "Fourier basis: solved"].settings
    assert lesson.settings == {**coupled, "coupled": False, "learning_rate": 10 * coupled["learning_rate"]}
    mean = last(lesson.runs()).mean()
    assert mean == pytest.approx(65, abs=5)
    assert mean > last(lesson.runs(learning_rate=coupled["learning_rate"])).mean() + 40


def acrobot_with_tiles(lesson: Lesson, _: Lessons) -> None:
    returns = lesson.runs().episode_returns
    assert returns[:, :10].mean() < -300
    assert returns[:, 200:300].mean() > -105
    assert returns[:, -100:].mean() > -90


def fourier_acrobot(lesson: Lesson, others: Lessons) -> None:
    assert weights(lesson) == 19 * 3
    assert weights(others["Acrobot-v1", "Tile coding"]) > 200_000
    lengths = -lesson.runs().episode_returns
    assert lengths[:, :100].mean() == pytest.approx(110, abs=5)
    assert lengths[:, 100:].mean() == pytest.approx(90, abs=5)


def acrobot_without_traces(lesson: Lesson, others: Lessons) -> None:
    returns = lesson.runs().episode_returns - others["Acrobot-v1", "Tile coding"].runs().episode_returns
    assert -returns[:, :100].mean() == pytest.approx(40, abs=15)
    assert -returns[:, -100:].mean() == pytest.approx(10, abs=4)


def acrobot_in_bins(lesson: Lesson, _: Lessons) -> None:
    assert np.prod(lesson.settings["bins"]) == 4096
    many = -lesson.runs().episode_returns[:, -100:].mean()
    few = -lesson.runs(bins=(2, 2, 2, 2, 4, 4)).episode_returns[:, -100:].mean()
    assert many == pytest.approx(300, abs=40)
    assert few == pytest.approx(many / 2, rel=0.2)


CLAIMS: Claims = {
    ("MountainCar-v0", "The article: fails"): article,
    ("MountainCar-v0", "Optimistic: better"): optimistic_car,
    ("MountainCar-v0", "Solved: tile coding"): solved_car,
    ("MountainCar-v0", "Fourier basis"): fourier_car,
    ("CartPole-v1", "Too coarse: fails"): coarse_pole,
    ("CartPole-v1", "Bins"): pole_in_bins,
    ("CartPole-v1", "Solved: tile coding"): solved_pole,
    ("CartPole-v1", "Fourier basis: solved"): fourier_pole,
    ("CartPole-v1", "Uncoupled: fails"): uncoupled_pole,
    ("Acrobot-v1", "Tile coding"): acrobot_with_tiles,
    ("Acrobot-v1", "Fourier basis"): fourier_acrobot,
    ("Acrobot-v1", "One-step Sarsa: slower"): acrobot_without_traces,
    ("Acrobot-v1", "Bins: slow"): acrobot_in_bins,
}
