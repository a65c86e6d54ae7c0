"""The schedule shows the rates that were used, and a plot on shared axes cuts no other one off."""

from typing import Any

import matplotlib.pyplot as plt
import pytest

import qtab
from qtab import plots

POLE = "CartPole-v1"
FALLING: dict[str, Any] = {"epsilon": 1.0, "min_epsilon": 0.0, "epsilon_schedule": "linear"}


def drawn(run: qtab.Run, label: str = "exploration rate") -> tuple[list[float], list[float]]:
    ax = plots.schedule(run)
    line: Any = next(line for line in ax.lines if str(line.get_label()).startswith(label))
    return list(line.get_xdata()), list(line.get_ydata())


def used(**settings: Any) -> tuple[list[float], qtab.Run]:
    """The exploration rate of each episode, as a callback sees it, and the run."""
    rates: list[float] = []

    def see(progress: Any) -> None:
        rates.append(progress.epsilon)

    return rates, qtab.train(POLE, seed=0, callback=see, callback_every=1, max_episode_steps=5, **settings)


def test_the_schedule_of_an_extended_run_is_the_one_that_was_used() -> None:
    first, short = used(episodes=10, **FALLING)
    run = qtab.resume(qtab.resume(short, 40), 100)
    whole, _ = used(episodes=40, **FALLING)
    longest, _ = used(episodes=100, **FALLING)
    episodes, rates = drawn(run)
    assert episodes == list(range(1, 101))
    assert rates == pytest.approx(first + whole[10:40] + longest[40:])
    assert plots.schedule(run).get_xlim() == (1, 100)


def test_a_stopped_run_is_drawn_up_to_its_last_episode() -> None:
    run = qtab.train(POLE, seed=0, episodes=50, callback=lambda progress: progress.episodes < 20, callback_every=20)
    episodes, _ = drawn(run)
    assert episodes == list(range(1, 21))
    assert plots.schedule(run).get_xlim() == (1, 20)
    visits = qtab.train(
        POLE,
        seed=0,
        episodes=50,
        learning_rate_schedule="visits",
        callback=lambda progress: progress.episodes < 1,
        callback_every=1,
    )
    assert drawn(visits)[0] == [1]


@pytest.mark.parametrize("draw", [qtab.plot, plots.schedule])
def test_a_shorter_run_on_the_same_axes_does_not_cut_off_a_longer_one(draw: Any) -> None:
    runs = {episodes: qtab.train(POLE, seed=0, episodes=episodes, max_episode_steps=5) for episodes in (40, 200)}
    for order in ((200, 40), (40, 200)):
        for ax, other in ([plt.figure().subplots()] * 2, plt.figure().subplots(2, 1, sharex=True)):
            draw(runs[order[0]], ax)
            draw(runs[order[1]], other)
            assert ax.get_xlim() == other.get_xlim() == (1 if draw is plots.schedule else 0, 200)
