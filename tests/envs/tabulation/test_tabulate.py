"""qtab.tabulate: the table of an environment has its exact transitions, and its optimum is that of the environment."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import RecordEpisodeStatistics, TimeLimit
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from support.environments.own.games.tic_tac_toe import LINES, TicTacToe
from support.environments.own.grids.key_and_door import KeyAndDoor
from support.environments.own.small import Gambler, NoisyWalk, Pig, WindyGrid
from support.lockstep.toy_text import TABLES

SETTINGS: Any = {"learning_rate": 0.5, "discount": 0.9, "initial_q": 0.0, "epsilon": 0.2, "preset": None}


def entries(table):
    return [
        (state, action, list(map(tuple, table[state][action])))
        for state in range(len(table))
        for action in range(len(table[0]))
    ]


@pytest.mark.parametrize("name", TABLES)
def test_the_table_of_toy_text_is_gymnasiums(name):
    env: Any = gym.make(name)
    table = qtab.tabulate(env)
    assert entries(table.P) == entries(env.unwrapped.P)
    assert np.array_equal(table.initial_state_distrib, env.unwrapped.initial_state_distrib)
    assert table.max_episode_steps == env.spec.max_episode_steps
    run, other = (qtab.train(of, episodes=20, seed=0, **SETTINGS) for of in (table, env))
    assert run.config.backend == "rust"
    assert np.array_equal(run.q_table, other.q_table)
    assert run.action_names == other.action_names


def test_the_masks_of_taxi_are_kept():
    env: Any = gym.make("Taxi-v4")
    table = qtab.tabulate(env)
    assert all(np.array_equal(table.action_mask(state), env.unwrapped.action_mask(state)) for state in range(500))
    one, other = (qtab.train(of, episodes=50, seed=1, action_mask=True, **SETTINGS) for of in (env, table))
    assert np.array_equal(one.q_table, other.q_table)


def solution(n_states, n_actions, outcomes, available=lambda state: None):
    """Value iteration in NumPy over ``outcomes(state, action) -> [(probability, state, reward, terminated)]``."""
    transitions = np.zeros((n_states, n_actions, n_states))
    rewards = np.zeros((n_states, n_actions))
    for state in range(n_states):
        for action in range(n_actions):
            for probability, following, reward, terminated in outcomes(state, action):
                rewards[state, action] += probability * reward
                transitions[state, action, following] += probability * (not terminated)
    values = np.zeros(n_states)
    for _ in range(3000):
        q_values = rewards + transitions @ values
        values = q_values.max(axis=1)
    return values


def grid_outcomes(env):
    """The rules of WindyGrid in another form: the place is row * columns + column."""

    def moved(state, direction):
        row, column = divmod(state, env.columns)
        row += {0: -1, 2: 1}.get(direction, 0)
        column += {1: 1, 3: -1}.get(direction, 0)
        row, column = np.clip(row, 0, env.rows - 1), np.clip(column, 0, env.columns - 1)
        return int(row * env.columns + column)

    def outcomes(state, action):
        last = env.rows * env.columns - 1
        if state == last:
            return [(1.0, state, 0.0, True)]
        chances = {direction: env.slip / 4 + (1 - env.slip) * (direction == action) for direction in range(4)}
        ends = [(chance, moved(state, direction)) for direction, chance in chances.items()]
        return [(chance, end, 10.0 if end == last else -1.0, end == last) for chance, end in ends]

    return outcomes


def test_a_grid_with_random_steps_has_the_values_of_its_rules():
    env = WindyGrid()
    table = qtab.tabulate(env)
    expected = solution(12, 4, grid_outcomes(env))
    best = qtab.optimum(table, method="value_iteration")
    numbers = [int(row * env.columns + column) for row, column in table.states]
    assert sorted(numbers) == list(range(12))
    assert np.allclose(best.values, expected[numbers], rtol=0, atol=1e-9)
    assert best.expected_return == pytest.approx((expected[0] + expected[1]) / 2)
    assert [tuple(observation) for observation in table.observations] == [tuple(map(int, s)) for s in table.states]
    assert table.state_names[:2] == ("(0, 0)", "(0, 1)")


def test_probabilities_are_exact_fractions_rounded_once():
    table = qtab.tabulate(WindyGrid(slip=0.1))
    found = {state: probability for probability, state, *_ in table.P[0][1]}
    start, right, below = (table.states.index(place) for place in ((0, 0), (0, 1), (1, 0)))
    assert found == {start: 0.05, right: 0.925, below: 0.025}


def test_the_gambler_has_the_values_of_his_problem():
    env = Gambler()
    table = qtab.tabulate(env)

    def outcomes(capital, action):
        stake = min(action + 1, capital, 20 - capital)
        ends = [(0.4, capital + stake), (0.6, capital - stake)]
        return [(chance, end, float(end == 20), end in (0, 20)) for chance, end in ends] if 0 < capital < 20 else []

    expected = solution(21, 10, outcomes)
    best = qtab.optimum(table, method="value_iteration")
    assert sorted(table.states) == list(range(21))
    assert np.allclose(best.values, expected[list(table.states)], rtol=0, atol=1e-12)
    assert table.P[0][0] == [(0.4, table.states.index(6), 0.0, False), (0.6, table.states.index(4), 0.0, False)]


def best_pig(held, turn, left):
    """The expected points of the dice game, by its rules."""
    if left == 0:
        return 0.0
    key = held, turn, left
    if key not in _PIG:
        after = min(held + turn, 15)
        hold = (after if left == 1 else 0.0) + best_pig(after, 0, left - 1)
        roll = (held if left == 1 else 0.0) + best_pig(held, 0, left - 1)
        more = [hold] * 5 if turn >= 30 else [best_pig(held, min(turn + die, 30), left) for die in range(2, 7)]
        _PIG[key] = max(hold, (roll + sum(more)) / 6)
    return _PIG[key]


_PIG: dict[tuple[int, int, int], float] = {}


def test_a_dice_game_has_the_values_of_its_rules():
    table = qtab.tabulate(Pig())
    best = qtab.optimum(table, max_episode_steps=200)
    assert best.expected_return == pytest.approx(best_pig(0, 0, 3), abs=1e-12)
    rolled = {table.states[state]: probability for probability, state, *_ in table.P[0][0]}
    assert rolled == {(0, 0, 2): 1 / 6, **{(0, die, 3): 1 / 6 for die in range(2, 7)}}


def best_of_board(board):
    """The expected result against a player that moves at random, by the rules of tic-tac-toe."""
    if board not in _BOARDS:
        free = [square for square in range(9) if board[square] == 0]
        _BOARDS[board] = max(result_of(board, square) for square in free)
    return _BOARDS[board]


_BOARDS: dict[tuple[int, ...], float] = {}


def result_of(board, square):
    board = (*board[:square], 1, *board[square + 1 :])
    if won(board, 1):
        return 1.0
    replies = [(*board[:reply], 2, *board[reply + 1 :]) for reply in range(9) if board[reply] == 0]
    if not replies:
        return 0.0
    return sum(-1.0 if won(reply, 2) else best_of_board(reply) for reply in replies) / len(replies)


def won(board, player):
    return any(all(board[square] == player for square in line) for line in LINES)


@pytest.mark.slow
def test_tic_tac_toe_has_the_values_of_its_rules_and_keeps_its_masks():
    table = qtab.tabulate(TicTacToe())
    best = qtab.optimum(table, max_episode_steps=9)
    assert best.expected_return == pytest.approx(best_of_board((0,) * 9), abs=1e-12)
    for number, board in enumerate(table.states):
        if table.P[number][0] != [(1.0, number, 0.0, True)]:
            assert np.array_equal(table.action_mask(number), board == 0)
            assert board[best.policy[number]] == 0
            assert best.values[number] == pytest.approx(best_of_board(tuple(board.tolist())), abs=1e-12)
    run = qtab.train(table, episodes=60_000, action_mask=True, seed=0, max_episode_steps=9, **SETTINGS)
    assert run.config.backend == "rust"
    assert best.gap(run).greedy_return > 0.9


def test_the_greedy_policy_trained_on_a_table_is_the_best_one():
    table = qtab.tabulate(TimeLimit(KeyAndDoor(length=5), 100))
    run = qtab.train(table, episodes=3000, seed=0)
    best = qtab.optimum(table)
    assert run.config.max_episode_steps == best.max_episode_steps == 100
    assert best.gap(run).greedy_return == pytest.approx(best.expected_return)
    assert qtab.verify(run, env=table).equal


def test_training_on_the_table_learns_the_values_of_the_environment():
    env = TimeLimit(WindyGrid(), 100)
    table = qtab.tabulate(env)
    best = qtab.optimum(table)
    run = qtab.train(table, episodes=2000, seed=0)
    returns = []
    for seed in range(300):
        observation, _ = env.reset(seed=seed)
        total, done = 0.0, False
        while not done:
            number = table.states.index(tuple(observation))
            observation, reward, terminated, truncated, _ = env.step(int(run.policy[number]))
            total, done = total + float(reward), terminated or truncated
        returns.append(total)
    assert np.mean(returns) == pytest.approx(best.expected_return, abs=0.5)


def test_listed_outcomes_are_used_as_they_are():
    table = qtab.tabulate(NoisyWalk())
    assert table.states == (1, 2, 0, 3, 4)
    assert np.array_equal(table.initial_state_distrib, [0.5, 0.5, 0, 0, 0])
    assert table.P[0][1] == [(0.25, 0, -1.0, False), (0.5, 1, -1.0, False), (0.25, 3, -1.0, False)]
    assert table.P[4][0] == [(1.0, 4, 0.0, True)]


class TableEnv(qtab.FunctionalEnv):
    """An environment that draws its transitions from a table: (states, actions, states) integers of 64ths."""

    def __init__(self, weights: Any) -> None:
        self.weights = weights
        self.observation_space = gym.spaces.Discrete(len(weights))
        self.action_space = gym.spaces.Discrete(weights.shape[1])

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        following = int(rng.choice(len(self.weights), p=self.weights[state, action] / 64))
        return following, float(10 * state + action), following == len(self.weights) - 1

    def observe(self, state: Any) -> Any:
        return state


@given(st.integers(2, 5), st.integers(1, 3), st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_the_table_of_an_environment_that_draws_from_a_table_is_this_table(n_states, n_actions, seed):
    rng = np.random.default_rng(seed)
    weights = rng.multinomial(64, rng.dirichlet(np.full(n_states, 0.5), (n_states, n_actions)))
    table, last = qtab.tabulate(TableEnv(weights)), n_states - 1
    for number, state in enumerate(table.states):
        for action in range(n_actions):
            found = {
                (table.states[following], reward, terminated): probability
                for probability, following, reward, terminated in table.P[number][action]
            }
            reached = {int(following): weights[state, action, following] / 64 for following in range(n_states)}
            expected = {(to, 10.0 * state + action, to == last): chance for to, chance in reached.items() if chance}
            assert found == ({(last, 0.0, True): 1.0} if state == last else expected)


def test_the_walk_reports_its_progress(monkeypatch):
    seen: list[int] = []
    monkeypatch.setattr("qtab._utils.progress.ProgressBar.move_to", lambda bar, done: seen.append(done))
    qtab.tabulate(WindyGrid())
    assert seen == list(range(1, 12))  # the goal has no actions


def test_names_reach_runs_and_their_files(tmp_path):
    env = WindyGrid()
    env.action_names = ("up", "right", "down", "left")  # type: ignore[attr-defined]
    table = qtab.tabulate(RecordEpisodeStatistics(TimeLimit(RecordEpisodeStatistics(env), 50)))
    run = qtab.train(table, episodes=10, seed=0)
    run.save(tmp_path / "run.npz")
    for known in (run, qtab.load(tmp_path / "run.npz")):
        assert known.axes[0].values == table.state_names
        assert known.action_names == ("up", "right", "down", "left")
    step = qtab.explain(run, env=table).steps[0]
    assert step.cell is not None
    assert step.state == f"state {table.state_names[step.cell[0]]}"


def test_a_table_can_be_tabulated_again():
    table = qtab.tabulate(TimeLimit(WindyGrid(), 50))
    again = qtab.tabulate(table)
    assert entries(again.P) == entries(table.P)
    assert (again.states, again.state_names, again.max_episode_steps) == (table.states, table.state_names, 50)
