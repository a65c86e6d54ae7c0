"""What the page says of the taxi and of blackjack."""

import numpy as np

import qtab
from support.playground.lessons import SEEDS, Claims, Lesson, Lessons, last


def taxi_exploring(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    returns = runs.episode_returns
    assert returns[:, :100].mean() < -200
    assert returns[:, 300:400].mean() < 0 < returns[:, 500:600].mean()
    optimum = qtab.optimum("Taxi-v4").expected_return
    assert (last(runs) > optimum - 0.5).all()
    assert lesson.settings["initial_q"] == 0


def taxi_optimistic(lesson: Lesson, others: Lessons) -> None:
    env = lesson.make()
    table, starts = env.P, np.flatnonzero(env.initial_state_distrib)  # type: ignore[attr-defined]
    best = np.asarray(qtab.optimum("Taxi-v4").values)
    runs = lesson.runs()
    for seed in range(SEEDS):
        policy = runs[seed].q_table.argmax(axis=1)
        for start in starts:
            state, earned, terminated, steps = int(start), 0.0, False, 0
            while not terminated and steps < 200:
                [(_, state, reward, terminated)] = table[state][int(policy[state])]
                earned, steps = earned + reward, steps + 1
            assert earned == best[start], (seed, start)
    assert lesson.settings["epsilon"] == 0
    assert lesson.settings["initial_q"] == 20
    assert 2 * lesson.settings["episodes"] == others["Taxi-v4", "ε falls to 0"].settings["episodes"]


def share_of_hits(runs: qtab.Runs, total: int, ace: int) -> float:
    """How often the greedy action is to hit, over the seeds and the dealer's cards."""
    values = np.stack([runs[seed].q_table[total, 1:, ace] for seed in range(SEEDS)])
    return float((values[..., 1] > values[..., 0]).mean())


def greedy_means(runs: qtab.Runs) -> list[float]:
    return [float(qtab.evaluate(runs[seed], episodes=20_000).returns.mean()) for seed in range(SEEDS)]


def sticking(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    for total in (19, 20, 21):
        assert share_of_hits(runs, total, 0) < 0.05
    assert share_of_hits(runs, 20, 1) < 0.05
    assert share_of_hits(runs, 17, 0) < 0.1
    assert share_of_hits(runs, 17, 1) > 0.8
    assert set(np.unique(runs.episode_returns)) == {-1.0, 0.0, 1.0}
    assert -0.07 < np.mean(greedy_means(runs)) < qtab.optimum("Blackjack-v1").expected_return < 0


def luck(lesson: Lesson, others: Lessons) -> None:
    few, many = lesson.runs(), others["Blackjack-v1", "ε falls to 0"].runs()
    assert max(greedy_means(few)) < min(greedy_means(many))
    totals = range(12, 22)
    changes = [np.abs(np.diff([share_of_hits(runs, total, 1) for total in totals])).sum() for runs in (few, many)]
    falls = [share_of_hits(runs, 12, 1) - share_of_hits(runs, 21, 1) for runs in (few, many)]
    assert changes[0] > 2 * falls[0], "no clear border"
    assert falls[1] > 0.8


CLAIMS: Claims = {
    ("Taxi-v4", "ε falls to 0"): taxi_exploring,
    ("Taxi-v4", "Optimistic: solved"): taxi_optimistic,
    ("Blackjack-v1", "ε falls to 0"): sticking,
    ("Blackjack-v1", "Too few games: luck"): luck,
}
