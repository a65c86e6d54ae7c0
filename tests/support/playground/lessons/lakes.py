"""What the page says of the frozen lakes."""

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

import qtab
from qtab.playground import definitions
from support.playground.lessons import SEEDS, Claims, Lesson, Lessons, last

MOVES = [(0, -1), (1, 0), (0, 1), (-1, 0)]
"""FrozenLake's actions: left, down, right, up."""
LARGE_LAKE = definitions()["environments"]["FrozenLake8x8-v1"]["layout"]


def unexplored_lake(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs(episodes=2000)
    assert runs.episode_returns.max() == 0
    assert all(not runs[seed].q_table.any() for seed in range(SEEDS))
    if "not slippery" in lesson.environment:
        assert {state for episode in lesson.greedy_of_all(runs) for state in episode.states} == {0}


def optimistic_lake(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    optimal = qtab.optimum("FrozenLake-v1", max_episode_steps=100).expected_return
    assert abs(last(runs).mean() - optimal) < 0.02
    assert 0.7 < optimal < 0.78, "about three of four"
    seen = lesson.greedy(runs[0], 0)
    assert seen.terminated
    assert seen.total == 0
    others = definitions()["environments"]["FrozenLake-v1"]["presets"]["solved"]
    assert {name for name, value in others.items() if lesson.settings[name] != value} == set()


def exploring_lake(lesson: Lesson, _: Lessons) -> None:
    halfway = lesson.settings["episodes"] // 2
    for seed in range(4):
        run = lesson.train(seed, snapshots=(halfway,))
        assert run.episode_returns[:halfway].mean() < 0.05
        assert run.episode_returns[-100:].mean() > 0.65
        assert run.snapshots is not None
        assert _goals(run.snapshots.tables[0, 0], seed) > _goals(run.q_table, seed) - 0.05


def _goals(table: NDArray[np.float64], seed: int) -> float:
    """How often the greedy policy of a table reaches the goal of the small lake."""
    env = gym.make("FrozenLake-v1")
    policy = table.argmax(axis=-1)
    goals = 0.0
    for episode in range(1000):
        state, _ = env.reset(seed=seed if episode == 0 else None)
        ended = False
        while not ended:
            state, reward, terminated, truncated, _ = env.step(policy[state])
            ended = terminated or truncated
            goals += float(reward)
    return goals / 1000


def optimistic_firm_lake(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    for seed, episode in enumerate(lesson.greedy_of_all(runs)):
        values = [runs[seed].q_table[state].max() for state in episode.states[:-1]]
        powers = lesson.settings["discount"] ** np.arange(len(values))[::-1]
        assert episode.total == 1
        np.testing.assert_allclose(values, powers, atol=1e-3)


def exploring_firm_lake(lesson: Lesson, _: Lessons) -> None:
    returns = lesson.runs().episode_returns
    for seed in range(4):
        first = int(returns[seed].argmax())
        run = lesson.train(seed, snapshots=(first, first + 1))
        assert run.snapshots is not None
        before, after = run.snapshots.tables[:, 0]
        assert not before.any()
        assert np.argwhere(after)[:, 0].tolist() == [14], "the state before the goal"


def optimistic_large_lake(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    shares = []
    for seed in range(SEEDS):
        away = beside = 0
        for state, action in enumerate(runs[seed].q_table.argmax(axis=-1).tolist()):
            row, column = divmod(state, 8)
            at = {move: _letter(row + down, column + right) for move, (down, right) in enumerate(MOVES)}
            holes = [move for move, letter in at.items() if letter == "H"]
            if _letter(row, column) in "HG" or not holes:
                continue
            beside += 1
            away += (action + 2) % 4 in holes
        shares.append(away / beside)
    assert min(shares) > 0.75


def _letter(row: int, column: int) -> str:
    return LARGE_LAKE[row][column] if 0 <= row < 8 and 0 <= column < 8 else ""


def exploring_large_lake(lesson: Lesson, others: Lessons) -> None:
    large, small = (one.runs().episode_returns for one in (lesson, others["FrozenLake-v1", "Exploring with ε"]))
    first_in_large, first_in_small = ((returns > 0).argmax(axis=1).mean() for returns in (large, small))
    assert 200 < first_in_large < 1000
    assert 50 < first_in_small < 150


def optimistic_large_firm_lake(lesson: Lesson, _: Lessons) -> None:
    runs = lesson.runs()
    assert {episode.steps for episode in lesson.greedy_of_all(runs)} == {14}
    initial = lesson.settings["initial_q"]
    alive = [state for state in range(64) if LARGE_LAKE[state // 8][state % 8] not in "HG"]
    assert all((runs[seed].q_table[alive] == initial).mean() < 0.05 for seed in range(SEEDS))


def exploring_large_firm_lake(lesson: Lesson, _: Lessons) -> None:
    near = [8 * row + column for row in range(4) for column in range(4 - row)]
    assert len(near) == 10
    for seed in range(2):
        counts = lesson.train(seed, visits=True).visits
        assert counts is not None
        visits = counts.sum(axis=-1)
        assert 0.4 < visits[near].sum() / visits.sum() < 0.5


CLAIMS: Claims = {
    ("FrozenLake-v1", "No exploration: fails"): unexplored_lake,
    ("FrozenLake-v1", "Optimistic: solved"): optimistic_lake,
    ("FrozenLake-v1", "Exploring with ε"): exploring_lake,
    ("FrozenLake-v1 (not slippery)", "No exploration: fails"): unexplored_lake,
    ("FrozenLake-v1 (not slippery)", "Optimistic: solved"): optimistic_firm_lake,
    ("FrozenLake-v1 (not slippery)", "Exploring with ε"): exploring_firm_lake,
    ("FrozenLake8x8-v1", "No exploration: fails"): unexplored_lake,
    ("FrozenLake8x8-v1", "Optimistic: solved"): optimistic_large_lake,
    ("FrozenLake8x8-v1", "Exploring with ε"): exploring_large_lake,
    ("FrozenLake8x8-v1 (not slippery)", "No exploration: fails"): unexplored_lake,
    ("FrozenLake8x8-v1 (not slippery)", "Optimistic: solved"): optimistic_large_firm_lake,
    ("FrozenLake8x8-v1 (not slippery)", "Exploring with ε"): exploring_large_firm_lake,
}
